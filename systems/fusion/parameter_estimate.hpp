#pragma once

#include "engine/signal/kalman.hpp"

#include <array>
#include <vector>

namespace bris {

/// A kind of measurement that worlds foretell, as ln q stage by stage.
struct ParameterChannel {
    double scatter = 0; ///< deviation by which the real specimen differs throughout from the worlds' whatever the parameters
    double noise = 0;   ///< deviation of the measurement
};

/// Two parameters of a model, learned from an ensemble of worlds that each believe in other ones.
///
/// What a measurement says of them is the worlds' regression of it on their parameters; what the regression leaves is chaos
/// and curvature, and counts as noise. A regression from few worlds is itself uncertain, the more so the farther from them:
/// its prediction is Student's t with the variance s^2 (1 + h), h the leverage (Seber and Lee 2003, 5.3). The posterior is
/// the product of these, by quadrature, not an update of means: slopes that are uncertain would make a Kalman gain too sure.
/// Chaos lasts: a world that is strong now is so a little later. So successive measurements of a channel are taken as
/// differences y - r y(before), with r by the mean correlation of what the regressions leave at successive times.
/// Worlds are never changed: their errors stay independent of what was measured, and they may run ahead.
class ParameterEstimate {
public:
    /// `prior`: of two parameters. `worlds`: N x 2, what each believes; N at least 6. The regression is of second order from
    /// 12 on. Throws InputError.
    /// `trust`: power of the likelihood, below 1 where measurements have shown to tell less than they seem to.
    ParameterEstimate(const Gaussian& prior, const Matrix& worlds, const std::vector<ParameterChannel>& channels, double trust = 1);

    /// One more measurement of a channel, and what each world foretold of it.
    void see(std::size_t channel, const Vector& foretold, double measured);

    /// Squared distance of a channel's last measurement from what parameters() made expect when it was last asked: chi
    /// square of one degree if all is well and worlds are many.
    double surprise(std::size_t channel) const;

    /// Mean and covariance of the parameters by all that was seen. The work is done here.
    const Gaussian& parameters();

private:
    struct Raw { Vector foretold, left; double measured; };
    struct Measurement { Vector coefficients; double difference, chaos, noise, own; }; // variances; own: of the specimen's own difference
    struct Channel {
        ParameterChannel settings;
        std::vector<Raw> raw;
        double correlation = 0; ///< sum of those between what is left at successive measurements
    };
    using Box = std::array<std::array<double, 2>, 2>; // of each parameter, low and high

    Vector terms_at(double a, double b) const;
    Vector left_of(const Vector& numbers) const;
    Measurement difference_of(const Channel& channel, std::size_t k) const;
    double log_likelihood(const Vector& terms, double own) const;
    Gaussian integral_over(const Box& box, double share) const;
    Gaussian integral() const;

    Gaussian prior_, known_;
    bool stale_ = false; ///< more was seen than known_ says
    double trust_;
    Eigen::Index terms_ = 3;
    Matrix design_;      // N x terms: 1, parameters less their mean, and their products
    Matrix information_; // inverse of design^T design
    Vector middle_;
    std::vector<Channel> channels_;
    std::vector<Measurement> measurements_;
};

/// The linear regression of numbers of N worlds on the worlds' parameters (N x P).
class WorldRegression {
public:
    explicit WorldRegression(const Matrix& worlds);
    /// What makes of the numbers their regression, taken at `parameters`: sums to 1.
    Vector weights_at(const Vector& parameters) const;
    /// N x N: makes of the numbers what the regression leaves of them.
    Matrix leaves() const;

private:
    Vector middle_;
    Matrix design_, information_; // 1 and parameters less their mean; inverse of design^T design
};

} // namespace bris

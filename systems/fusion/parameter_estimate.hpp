#pragma once

#include "engine/signal/kalman.hpp"

#include <vector>

namespace bris {

/// A kind of measurement that worlds foretell, as ln q stage by stage.
struct ParameterChannel {
    double scatter = 0; ///< deviation by which the real specimen differs from the worlds' whatever the parameters
    double noise = 0;   ///< deviation of the measurement
    double memory = 4;  ///< of that difference: it is like itself by exp(-|distance| / memory)
};

/// Two parameters of a model, learned from an ensemble of worlds that each believe in other ones.
///
/// What a measurement says of them is the worlds' regression of it on their parameters; what the regression leaves is chaos
/// and curvature, and counts as noise. A regression from few worlds is itself uncertain, the more so the farther from them:
/// its prediction is Student's t with the variance s^2 (1 + h), h the leverage (Seber and Lee 2003, 5.3). The posterior is
/// the product of these, by quadrature, not an update of means: slopes that are uncertain would make a Kalman gain too sure.
/// The nodes stand along the axes of what is known so far, while the likelihood comes in by shares.
/// Chaos lasts: a world that is strong now is so a little later. So successive measurements of a channel are taken as
/// differences y - r y(before), with r by the mean correlation of what the regressions leave at successive times.
/// How a real specimen differs from the worlds', which are all of one packing, no world shows. It lasts too: a normal process
/// of its own (Kennedy and O'Hagan 2001), in each channel; with it measurements are taken together, as normal.
/// Worlds are never changed: their errors stay independent of what was measured, and they may run ahead.
class ParameterEstimate {
public:
    static constexpr std::size_t fewest_worlds = 6;
    /// `prior`: of two parameters. `worlds`: N x 2, what each believes; N at least fewest_worlds. The regression is of second order from
    /// 12 on. Throws InputError.
    /// `trust`: power of the likelihood, below 1 where worlds have shown to tell less of each other than they seem to; where
    /// specimens scatter, of the variance of chaos only, which that does not touch.
    /// `more_worlds`: besides these, that the order of the regression goes by: what tries an estimate with some left out.
    ParameterEstimate(const Gaussian& prior, const Matrix& worlds, const std::vector<ParameterChannel>& channels, double trust = 1, Eigen::Index more_worlds = 0);

    /// One more measurement of a channel, and what each world foretold of it. `place`: where along the memory of the channel.
    void see(std::size_t channel, const Vector& foretold, double measured, double place = 0);

    /// Squared distance of a channel's last measurement from what parameters() made expect when it was last asked: chi
    /// square of one degree if all is well and worlds are many.
    double surprise(std::size_t channel) const;

    /// Mean and covariance of the parameters by all that was seen. The work is done here.
    const Gaussian& parameters();

private:
    struct Raw { Vector foretold, left; double measured, place; };
    struct Measurement { Vector coefficients; double difference, lasting, freedom, chaos, noise; }; // the last two are variances
    struct Seen {
        std::vector<Measurement> measurements;
        Matrix own; // covariance of what the specimen's own difference adds to them; empty: none
    };
    struct Channel {
        ParameterChannel settings;
        std::vector<Raw> raw;
        double correlation = 0; ///< sum of those between what is left at successive measurements
    };
    Vector terms_at(double a, double b) const;
    Vector left_of(const Vector& numbers) const;
    Measurement difference_of(const Channel& channel, std::size_t k) const;
    Seen seen_of(const Channel& channel) const;
    double log_likelihood(const Vector& at) const;
    double log_likelihood(const Seen& seen, const Vector& terms) const;
    Gaussian integral_around(const Gaussian& known, double share) const;
    Gaussian integral() const;

    Gaussian prior_, known_;
    bool stale_ = false; ///< more was seen than known_ says
    double trust_;
    Eigen::Index terms_ = 3;
    Matrix design_;      // N x terms: 1, parameters less their mean, and their products
    Matrix information_; // inverse of design^T design
    Vector middle_;
    std::vector<Channel> channels_;
    std::vector<Seen> seen_; // of each channel, as parameters() took them
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

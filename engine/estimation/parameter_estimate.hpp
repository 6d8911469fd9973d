#pragma once

#include "engine/estimation/kalman.hpp"

#include <vector>

namespace bris {

/// A measurement of something that worlds foretell, as ln q at some strain.
struct ParameterMeasurement {
    double value;
    double noise = 0;   ///< deviation of the measurement
    double scatter = 0; ///< deviation by which the real specimen differs from the worlds' whatever
                        ///< the parameters
    double stage = 0;   ///< along the test
};
/// How what a specimen differs by is like itself: one that is stronger now is so a little later,
/// and widens more too.
struct SpecimenCorrelation {
    double memory = 4;   ///< along the test: correlation of exp(-distance / memory)
    double channels = 0; ///< correlation between channels, in [0, 1)
};

/// Two parameters of a model, learned from an ensemble of worlds that each believe in other ones.
///
/// What a measurement says of them is the worlds' regression of it on their parameters; what the
/// regression leaves is chaos and curvature, and counts as noise. A regression from few worlds is
/// itself uncertain, the more so the farther from them: its prediction is Student's t with the
/// variance s^2 (1 + h), h the leverage (Seber and Lee 2003, 5.3). The posterior is the product of
/// these, by quadrature, not an update of means: slopes that are uncertain would make a Kalman gain
/// too sure. The nodes stand along the axes of what is known so far, while the likelihood comes in
/// by shares. Chaos lasts: a world that is strong now is so a little later. So successive
/// measurements of a channel are taken as differences y - r y(before), with r by the mean
/// correlation of what the regressions leave at successive times. How a real specimen differs from
/// the worlds', which are all of one packing, no world shows. It lasts too, and channels share it:
/// a normal process of its own (Kennedy and O'Hagan 2001); with it all measurements are taken
/// together, as normal. Worlds are never changed: their errors stay independent of what was
/// measured, and they may run ahead.
class ParameterEstimate {
public:
    static constexpr std::size_t fewest_members = 6;
    /// `prior`: of two parameters. `members`: N x 2, what each believes; N at least fewest_members.
    /// The regression is of second order from 12 on. `channels`: kinds of measurement. Throws
    /// InputError. `tempering`: power of the likelihood, below 1 where worlds have shown to tell
    /// less of each other than they seem to; where specimens scatter, of the variance of chaos
    /// only, which that does not touch. `excluded_members`: besides these, that the order of the
    /// regression goes by: what tries an estimate with some left out.
    ParameterEstimate(const Gaussian& prior, const Matrix& members, std::size_t channels,
                      double tempering = 1, Eigen::Index excluded_members = 0,
                      SpecimenCorrelation specimen_correlation = {});

    /// One more measurement of a channel, and what each world foretold of it.
    void observe(std::size_t channel, const Vector& forecast, const ParameterMeasurement& measured);

    /// Squared distance of a channel's last measurement from what parameters() made expect when it
    /// was last asked: chi square of one degree if all is well and worlds are many.
    double normalised_innovation_squared(std::size_t channel) const;

    /// Mean and covariance of the parameters by all that was seen. The work is done here.
    const Gaussian& parameters();

private:
    struct Raw {
        Vector forecast, residuals;
        ParameterMeasurement measured;
    };
    struct Difference {
        Vector coefficients;
        double difference, lasting, freedom, divergence, noise;
    };                    // the last two are variances
    struct Observations { // channel by channel
        std::vector<Difference> differences;
        Matrix own; // covariance of what the specimen's own difference adds to them; empty: none
    };
    struct Channel {
        std::vector<Raw> raw;
        double correlation = 0; ///< sum of those between what is left at successive measurements
    };
    Vector terms_at(double a, double b) const;
    Vector residuals_of(const Vector& numbers) const;
    Difference difference_of(const Channel& channel, std::size_t k) const;
    Observations observations() const;
    double log_likelihood(const Vector& at) const;
    Gaussian integral_around(const Gaussian& posterior, double share) const;
    Gaussian integral() const;

    Gaussian prior_, posterior_;
    bool stale_ = false; ///< more was seen than known_ says
    double tempering_;
    SpecimenCorrelation specimen_correlation_;
    Eigen::Index terms_ = 3;
    Matrix design_;      // N x terms: 1, parameters less their mean, and their products
    Matrix information_; // inverse of design^T design
    Vector middle_;
    std::vector<Channel> channels_;
    Observations observations_; // as parameters() took them
};

/// The linear regression of numbers of N worlds on the worlds' parameters (N x P).
class EnsembleRegression {
public:
    explicit EnsembleRegression(const Matrix& members);
    /// What makes of the numbers their regression, taken at `parameters`: sums to 1.
    Vector weights_at(const Vector& parameters) const;
    /// N x N: makes of the numbers what the regression leaves of them.
    Matrix residual_projection() const;

private:
    Vector middle_;
    Matrix design_, information_; // 1 and parameters less their mean; inverse of design^T design
};

} // namespace bris

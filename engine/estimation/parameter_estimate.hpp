#pragma once

#include "engine/estimation/kalman.hpp"

#include <vector>

namespace bris {

/// A measurement of a quantity that the ensemble members forecast, as ln q at some strain.
struct ParameterMeasurement {
    double value;
    /// Standard deviation of the measurement error.
    double noise = 0;
    /// Standard deviation by which the real specimen differs from the members for reasons other
    /// than the parameters.
    double scatter = 0;
    double stage = 0; ///< along the test
};
/// Correlation of the deviation of a real specimen from the members: a specimen that is stronger
/// than they are at one stage is still so a little later, and dilates more too.
struct SpecimenCorrelation {
    /// Correlation length along the test, in the unit of `stage`: the correlation is exp(-distance
    /// / memory).
    double memory = 4;
    double channels = 0; ///< correlation between channels, in [0, 1)
};

/// Estimates two parameters of a model from an ensemble whose members have different parameters.
///
/// The forecasts of each measurement are regressed on the members' parameters. The residuals
/// contain the divergence of perturbed runs and the curvature of the model, and count as noise. A
/// regression from few members is itself uncertain, the more so far away from them: its prediction
/// follows Student's t distribution with the variance s^2 (1 + h), where h is the leverage (Seber
/// and Lee 2003, section 5.3). The posterior is the product of the prior and these likelihoods,
/// integrated by quadrature. A Kalman update of the mean is not used, because uncertain slopes
/// would make its gain overconfident. The quadrature nodes are aligned with the principal axes of
/// the current posterior, and the likelihood is introduced in stages.
///
/// Divergence is correlated along the test: a member that is strong at one stage is strong a little
/// later. Successive measurements of a channel are therefore taken as differences y - r y(before),
/// where r follows from the mean correlation of the regression residuals at successive stages. The
/// difference between a real specimen and the members, which all have the same packing, cannot be
/// learned from the ensemble. It is also correlated along the test and between channels, and is
/// modelled as a separate Gaussian process (model discrepancy: Kennedy and O'Hagan 2001); with it,
/// all measurements are treated jointly as normal. The members are never changed, so that their
/// errors stay independent of the measurements and they may run ahead of them.
class ParameterEstimate {
public:
    static constexpr std::size_t fewest_members = 6;
    /// `prior`: two parameters. `members`: N x 2, the parameters of the members, N >=
    /// fewest_members; the regression is of second order from N = 12 on. `channels`: number of
    /// kinds of measurement. `tempering`: exponent of the likelihood (likelihood tempering), below
    /// 1 if members have been found to predict one another less well than their regressions claim;
    /// with a specimen scatter it divides only the variance of the divergence, not that of the
    /// scatter. `excluded_members`: number of members to add to N when the order of the regression
    /// is chosen, for tests that leave some members out. Throws InputError.
    ParameterEstimate(const Gaussian& prior, const Matrix& members, std::size_t channels,
                      double tempering = 1, Eigen::Index excluded_members = 0,
                      SpecimenCorrelation specimen_correlation = {});

    /// Adds a measurement of a channel and its forecasts, one per member. Throws InputError if the
    /// number of forecasts differs.
    void observe(std::size_t channel, const Vector& forecast, const ParameterMeasurement& measured);

    /// Normalised innovation squared of a channel's last measurement, with respect to the result of
    /// the last call of parameters(). Chi-squared with one degree of freedom if the model is
    /// consistent and the ensemble is large. NaN if the channel has no measurement.
    double normalised_innovation_squared(std::size_t channel) const;

    /// Posterior mean and covariance of the parameters, given all measurements. The quadrature runs
    /// here, if measurements were added since the last call.
    const Gaussian& parameters();

private:
    struct Raw {
        Vector forecast, residuals;
        ParameterMeasurement measured;
    };
    // y - r y(before) of one channel: regression coefficients, the measured difference, r, degrees
    // of freedom, and the variances of the divergence and of the measurement error
    struct Difference {
        Vector coefficients;
        double difference, lasting, freedom, divergence, noise;
    };
    struct Observations { // channel by channel
        std::vector<Difference> differences;
        Matrix own; // of the specimen's own deviation in the differences; empty: no scatter
    };
    struct Channel {
        std::vector<Raw> raw;
        /// Sum of the correlations between the residuals of successive measurements.
        double correlation = 0;
    };
    Vector terms_at(double a, double b) const;
    Vector residuals_of(const Vector& numbers) const;
    Difference difference_of(const Channel& channel, std::size_t k) const;
    Observations observations() const;
    double log_likelihood(const Vector& at) const;
    Gaussian integral_around(const Gaussian& posterior, double share) const;
    Gaussian integral() const;

    Gaussian prior_, posterior_;
    /// Measurements were added after posterior_ was computed.
    bool stale_ = false;
    double tempering_;
    SpecimenCorrelation specimen_correlation_;
    Eigen::Index terms_ = 3;
    Matrix design_;      // N x terms: 1, parameters minus their mean, and products of these
    Matrix information_; // inverse of design^T design
    Vector middle_;
    std::vector<Channel> channels_;
    Observations observations_; // as used by the last call of parameters()
};

/// Linear regression of N values, one per member, on the members' parameters (N x P).
class EnsembleRegression {
public:
    explicit EnsembleRegression(const Matrix& members);
    /// Weights, one per member and with the sum 1, that turn the values into the regression's
    /// prediction at `parameters`.
    Vector weights_at(const Vector& parameters) const;
    /// N x N: projects the values onto the residuals of their regression.
    Matrix residual_projection() const;

private:
    Vector middle_;
    Matrix design_, information_; // 1 and parameters minus their mean; inverse of design^T design
};

} // namespace bris

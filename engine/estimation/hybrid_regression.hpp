#pragma once

#include "engine/estimation/leave_one_out_regression.hpp"

#include <vector>

namespace bris {

/// Weights exp(-d / 2T) of samples at squared distances d from a measurement, with the sum 1. The
/// temperature T is such that the weights count as much as `effective` equal ones, 1 / sum w^2
/// (Kong, Liu and Wong 1994, J. Am. Stat. Assoc. 89:278). Throws InputError if a distance is no
/// number, or if `effective` is not from 1 to the number of samples.
Vector tempered_weights(const Vector& squared_distances, double effective);

/// Predicts targets from features over N samples as a mean of two estimates: the linear regression
/// (LeaveOneOutRegression), and the mean of the samples weighted by how near their features are.
/// The regression is finer among the samples; far from them it extrapolates, which weights never
/// do. Hybrids of ensemble Kalman and particle filters combine the same two estimates (Frei and
/// Kuensch 2013, Biometrika 100:781). For each group of targets the weighted samples have the share
/// with the smallest leave-one-out residuals; beyond the samples, at a distance d > 1, the share of
/// the regression falls as 1 / d^2.
class HybridRegression {
public:
    using Prediction = LeaveOneOutRegression::Prediction;

    /// As LeaveOneOutRegression.
    HybridRegression(const Matrix& features, const Vector& weights, const Matrix& targets,
                     std::vector<TargetGroup> groups);

    /// Predicts the targets for p features. The deviation is the root mean square of the
    /// leave-one-out residuals of the hybrid, and grows with leverage and distance as that of the
    /// regression.
    Prediction predict(const Vector& features) const;
    Prediction prior() const { return regression_.prior(); }
    /// N, weights of the samples for p features; they count as much as N / 10 equal ones, at least
    /// four.
    Vector sample_weights(const Vector& features) const;

    /// N x t: targets minus their predictions from all other samples.
    const Matrix& residuals() const { return residuals_; }
    /// Share of the weighted samples in each group of targets, within the samples.
    const std::vector<double>& shares() const { return shares_; }
    double freedom() const { return regression_.freedom(); }

private:
    Vector distances_to(const Vector& standardised) const; ///< squared, N
    Matrix residuals_of_weights() const;

    std::vector<TargetGroup> groups_;
    LeaveOneOutRegression regression_;
    Matrix samples_, targets_; ///< N x p standardised features, N x t
    double effective_;         ///< number of equal weights
    Matrix residuals_;
    Vector deviation_ratio_; ///< t, of the residuals of hybrid and regression
    std::vector<double> shares_;
};

} // namespace bris

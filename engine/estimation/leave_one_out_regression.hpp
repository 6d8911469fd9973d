#pragma once

#include "engine/estimation/kalman.hpp"

#include <vector>

namespace bris {

/// Neighbouring targets whose regression has the same strength of regularisation.
struct TargetGroup {
    Eigen::Index first, count;
};

/// Regularised linear regression of targets on features over N samples, which is the linear
/// estimate of the targets from measured features with the empirical covariances of the samples:
/// gain C_yx (C_xx + lambda / 10 I)^-1. Features are standardised and multiplied by weights. For
/// each group of targets, lambda is the one of 11 values from 10^-2.5 to 10^2.5 with the smallest
/// leave-one-out residuals, relative to the variance of each target; where none of them beats the
/// mean of the samples, the mean is used. Leave-one-out residuals are those of N regressions, each
/// without one sample, in closed form (Allen 1974, Technometrics 16:125): the residual over one
/// minus the leverage.
class LeaveOneOutRegression {
public:
    /// `features`: N x p, `targets`: N x t, `weights`: p. The groups cover all targets, in order.
    /// Throws InputError if the sizes differ or if N < 4.
    LeaveOneOutRegression(const Matrix& features, const Vector& weights, const Matrix& targets,
                          std::vector<TargetGroup> groups);

    struct Prediction {
        Vector mean;      ///< t
        Vector deviation; ///< t, standard deviation of the prediction error
        /// Distance of the features from the mean of the samples, relative to a distance that 95 %
        /// of the samples do not exceed when they are left out themselves.
        double distance;
    };
    /// Predicts the targets for p features. The deviation is the root mean square of the
    /// leave-one-out residuals. It is larger where the leverage is larger than the mean leverage of
    /// the samples, and in proportion to the distance if that exceeds 1: far from all samples, no
    /// prediction is certain.
    Prediction predict(const Vector& features) const;
    /// The prediction without any feature: mean and standard deviation of the samples, for a new
    /// sample.
    Prediction prior() const;

    /// N x t: targets minus their predictions from all other samples.
    const Matrix& residuals() const { return residuals_; }
    /// lambda of each group; infinity where the mean is used.
    const std::vector<double>& strengths() const { return strengths_; }
    /// Degrees of freedom of the deviations, N - 1.
    double freedom() const { return static_cast<double>(residuals_.rows() - 1); }

    /// p features minus their means, over their deviations, times their weights: those whose linear
    /// function the prediction is. Throws InputError if a feature is no number.
    Vector standardised(const Vector& features) const;

private:
    void choose_strengths(const Matrix& left, const Vector& squares);
    void measure_distances(const Matrix& samples);
    double distance(const Vector& standardised) const;

    std::vector<TargetGroup> groups_;
    Vector feature_mean_, feature_scale_; // scale: weight over standard deviation
    Vector target_mean_, target_deviation_;
    Matrix basis_;                                  // p x r, right singular vectors of the samples
    Vector singular_;                               // r, singular values
    Matrix projected_;                              // r x t, left singular vectors times targets
    Matrix residuals_;                              // N x t
    Vector rms_;                                    // t, of the residuals
    std::vector<double> strengths_, mean_leverage_; // of the groups
    Matrix inverse_covariance_;                     // p x p, of the distance
    double usual_distance_ = 1;
};

} // namespace bris

#pragma once

#include "engine/math.hpp"

namespace bris {

template <class S>
using VectorOf = Eigen::Matrix<S, Eigen::Dynamic, 1>;
template <class S>
using MatrixOf = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = VectorOf<double>;
using Matrix = MatrixOf<double>;

// S is double; float serves the tests of rounding. The templates are instantiated once for each, in
// kalman.cpp and beside the tests, so that the heavy parts of Eigen are compiled only there.

/// Lower triangular L with L L^T = A A^T. A must have at least as many columns as rows.
template <class S>
MatrixOf<S> triangle_of(const MatrixOf<S>& a);

/// Lower triangular L with L L^T = `covariance`. The covariance may be singular: what is known
/// exactly has zero variance.
template <class S>
MatrixOf<S> root_of(const MatrixOf<S>& covariance);

/// A normal distribution of n variables. The covariance is stored as a triangular root, so that it
/// stays symmetric and positive semi-definite under rounding. Joseph's form preserves this only up
/// to rounding errors, and P - K H P does not preserve it (Bierman 1977).
template <class S>
struct GaussianOf {
    VectorOf<S> mean;
    MatrixOf<S> root; ///< lower triangular; covariance = root root^T

    GaussianOf() = default;
    /// n variables that are known to be 0.
    explicit GaussianOf(Eigen::Index n)
        : mean(VectorOf<S>::Zero(n)), root(MatrixOf<S>::Zero(n, n)) {}
    GaussianOf(const VectorOf<S>& mean_of, const MatrixOf<S>& covariance)
        : mean(mean_of), root(root_of<S>(covariance)) {}
    MatrixOf<S> covariance() const;
};
using Gaussian = GaussianOf<double>;

/// A linear model x(next) = F x + w, where w has the covariance Q.
template <class S>
struct TransitionOf {
    MatrixOf<S> F, Q;
};
using Transition = TransitionOf<double>;

/// Prediction of the Kalman filter: mean F x, covariance F P F^T + Q.
template <class S>
GaussianOf<S> predict(const GaussianOf<S>& now, const TransitionOf<S>& t);

/// Result of updating an estimate of n variables with a measurement of m numbers.
template <class S>
struct UpdateOf {
    GaussianOf<S> estimate;
    MatrixOf<S> gain; ///< n x m
    VectorOf<S> innovation;
    MatrixOf<S> innovation_root; ///< lower triangular, of H P H^T + R
    /// Normalised innovation squared (NIS): chi-squared with m degrees of freedom if the filter is
    /// consistent.
    S squared_distance = 0;
    S log_likelihood = 0; ///< of the measurement
};

/// Update of the Kalman filter for the measurement y = H x + v, where v has the covariance R, given
/// the innovation y - H x. It uses one orthogonal triangularisation of the roots (array form:
/// Kailath, Sayed and Hassibi 2000, section 12.3), which needs no inverse and agrees with Joseph's
/// form (I - K H) P (I - K H)^T + K R K^T. H P H^T + R must be regular.
template <class S>
UpdateOf<S> correct(const GaussianOf<S>& before, const VectorOf<S>& innovation,
                    const MatrixOf<S>& H, const MatrixOf<S>& R);

/// The same update, given the measurement y.
template <class S>
UpdateOf<S> update(const GaussianOf<S>& before, const VectorOf<S>& y, const MatrixOf<S>& H,
                   const MatrixOf<S>& R);

/// Normalised estimation error squared (NEES) of the true value x: chi-squared with n degrees of
/// freedom if the estimate is consistent. The covariance must be regular.
double squared_distance(const Gaussian& estimate, const Vector& x);

} // namespace bris

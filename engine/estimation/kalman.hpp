#pragma once

#include "engine/math.hpp"

namespace bris {

template <class S>
using VectorOf = Eigen::Matrix<S, Eigen::Dynamic, 1>;
template <class S>
using MatrixOf = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = VectorOf<double>;
using Matrix = MatrixOf<double>;

// S is double; float is for tests of rounding. Defined, and the heavy parts of Eigen compiled, once
// in kalman.cpp.

/// Lower triangular L with L L^T = A A^T; A has at least as many columns as rows.
template <class S>
MatrixOf<S> triangle_of(const MatrixOf<S>& a);

/// Lower triangular L with L L^T = `covariance`, which may be singular: what is known for certain
/// has no variance.
template <class S>
MatrixOf<S> root_of(const MatrixOf<S>& covariance);

/// A normal distribution of n numbers. Its covariance is kept by a triangular root, so that it is
/// symmetric and without negative eigenvalues whatever rounding does: Joseph's form keeps that to
/// rounding, P - K H P does not (Bierman 1977).
template <class S>
struct GaussianOf {
    VectorOf<S> mean;
    MatrixOf<S> root; ///< lower triangular; covariance = root root^T

    GaussianOf() = default;
    /// Of n numbers, all known to be 0.
    explicit GaussianOf(Eigen::Index n)
        : mean(VectorOf<S>::Zero(n)), root(MatrixOf<S>::Zero(n, n)) {}
    GaussianOf(const VectorOf<S>& mean_of, const MatrixOf<S>& covariance)
        : mean(mean_of), root(root_of<S>(covariance)) {}
    MatrixOf<S> covariance() const;
};
using Gaussian = GaussianOf<double>;

/// x(next) = F x + w, w of covariance Q.
template <class S>
struct TransitionOf {
    MatrixOf<S> F, Q;
};
using Transition = TransitionOf<double>;

/// Kalman's prediction: mean F x, covariance F P F^T + Q.
template <class S>
GaussianOf<S> predict(const GaussianOf<S>& now, const TransitionOf<S>& t);

/// What a measurement of m numbers makes of an estimate of n.
template <class S>
struct UpdateOf {
    GaussianOf<S> estimate;
    MatrixOf<S> gain; ///< n x m
    VectorOf<S> innovation;
    MatrixOf<S> innovation_root; ///< lower triangular, of H P H^T + R
    S squared_distance = 0; ///< of the innovation, in its covariance: chi square of m degrees (NIS)
    S log_likelihood = 0;   ///< of the measurement
};

/// Kalman's update for the measurement y = H x + v, v of covariance R, given the innovation y - H
/// x. By one orthogonal triangularisation of roots (the array form: Kailath, Sayed and Hassibi
/// 2000, 12.3), which needs no inverse; what it gives is that of Joseph's form, (I - K H) P (I - K
/// H)^T + K R K^T. H P H^T + R must be regular.
template <class S>
UpdateOf<S> correct(const GaussianOf<S>& before, const VectorOf<S>& innovation,
                    const MatrixOf<S>& H, const MatrixOf<S>& R);

/// The same, given the measurement y.
template <class S>
UpdateOf<S> update(const GaussianOf<S>& before, const VectorOf<S>& y, const MatrixOf<S>& H,
                   const MatrixOf<S>& R);

/// Squared distance of x from the mean, in the covariance, which must be regular: chi square of n
/// degrees (NEES).
double squared_distance(const Gaussian& estimate, const Vector& x);

} // namespace bris

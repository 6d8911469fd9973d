#pragma once

// Definitions of the templates of kalman.hpp, for the two files that instantiate them.

#include "engine/estimation/kalman.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace bris {

template <class S>
MatrixOf<S> triangle_of(const MatrixOf<S>& a) {
    const Eigen::HouseholderQR<MatrixOf<S>> qr(a.transpose());
    return qr.matrixQR().topRows(a.rows()).template triangularView<Eigen::Upper>().transpose();
}

template <class S>
MatrixOf<S> root_of(const MatrixOf<S>& covariance) {
    const Eigen::LDLT<MatrixOf<S>> ldlt(covariance);
    MatrixOf<S> root = ldlt.matrixL();
    root *= ldlt.vectorD().cwiseMax(S(0)).cwiseSqrt().asDiagonal();
    return triangle_of<S>(ldlt.transpositionsP().transpose() * root);
}

template <class S>
MatrixOf<S> GaussianOf<S>::covariance() const {
    return root * root.transpose();
}

template <class S>
GaussianOf<S> predict(const GaussianOf<S>& now, const TransitionOf<S>& t) {
    const Eigen::Index n = now.mean.size();
    MatrixOf<S> roots(n, 2 * n);
    roots << t.F * now.root, root_of<S>(t.Q);
    GaussianOf<S> next;
    next.mean = t.F * now.mean;
    next.root = triangle_of<S>(roots);
    return next;
}

template <class S>
UpdateOf<S> correct(const GaussianOf<S>& before, const VectorOf<S>& innovation,
                    const MatrixOf<S>& H, const MatrixOf<S>& R) {
    const Eigen::Index n = before.mean.size(), m = innovation.size();
    MatrixOf<S> roots = MatrixOf<S>::Zero(m + n, m + n);
    roots.topLeftCorner(m, m) = root_of<S>(R);
    roots.topRightCorner(m, n) = H * before.root;
    roots.bottomRightCorner(n, n) = before.root;
    const MatrixOf<S> after = triangle_of<S>(roots);
    UpdateOf<S> c;
    c.innovation = innovation;
    c.innovation_root = after.topLeftCorner(m, m);
    const MatrixOf<S> cross = after.bottomLeftCorner(n, m), cross_rows = cross.transpose();
    const VectorOf<S> whitened =
        c.innovation_root.template triangularView<Eigen::Lower>().solve(innovation);
    c.gain = c.innovation_root.transpose()
                 .template triangularView<Eigen::Upper>()
                 .solve(cross_rows)
                 .transpose();
    c.estimate.mean = before.mean + cross * whitened;
    c.estimate.root = after.bottomRightCorner(n, n);
    c.squared_distance = whitened.squaredNorm();
    c.log_likelihood = S(-0.5) * (S(m) * S(std::log(2 * pi)) + c.squared_distance) -
                       c.innovation_root.diagonal().cwiseAbs().array().log().sum();
    return c;
}

template <class S>
UpdateOf<S> update(const GaussianOf<S>& before, const VectorOf<S>& y, const MatrixOf<S>& H,
                   const MatrixOf<S>& R) {
    return correct<S>(before, y - H * before.mean, H, R);
}

/// Instantiates the filter for a type of number.
#define BRIS_KALMAN_OF(S)                                                                          \
    template MatrixOf<S> triangle_of<S>(const MatrixOf<S>&);                                       \
    template MatrixOf<S> root_of<S>(const MatrixOf<S>&);                                           \
    template struct GaussianOf<S>;                                                                 \
    template GaussianOf<S> predict<S>(const GaussianOf<S>&, const TransitionOf<S>&);               \
    template UpdateOf<S> correct<S>(const GaussianOf<S>&, const VectorOf<S>&, const MatrixOf<S>&,  \
                                    const MatrixOf<S>&);                                           \
    template UpdateOf<S> update<S>(const GaussianOf<S>&, const VectorOf<S>&, const MatrixOf<S>&,   \
                                   const MatrixOf<S>&)

} // namespace bris

#include "engine/estimation/ensemble_filter.hpp"

#include "engine/errors.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace bris {

namespace {

void check(const Matrix& members, const EnsembleObservation& o) {
    const Eigen::Index m = o.measured.size();
    require(members.cols() >= 2 && o.forecast.cols() == members.cols() && o.forecast.rows() == m &&
                o.variance.size() == m,
            fmt::format("ensemble update: expected at least 2 members, and {} numbers, forecasts "
                        "and variances, found {} members, {} x {} forecasts and {} variances",
                        m, members.cols(), o.forecast.rows(), o.forecast.cols(),
                        o.variance.size()));
    require((o.variance.array() > 0).all(),
            "ensemble update: expected positive variances of the measurement errors");
}

/// Members, n x N, as their mean and their deviations from it.
struct Spread {
    Vector mean;       // n
    Matrix deviations; // n x N
};

Spread spread_of(const Matrix& members) {
    const Vector mean = members.rowwise().mean();
    return {mean, members.colwise() - mean};
}

/// The members whose deviations are multiplied by a matrix N x N.
Matrix transformed(const Spread& members, const Matrix& weights) {
    return (members.deviations * weights).colwise() + members.mean;
}

/// Forecasts and innovation in units of the measurement errors; deviations over sqrt(N - 1).
struct Scaled {
    Matrix deviations; // m x N
    Vector innovation; // m
};

Scaled scaled(const EnsembleObservation& o) {
    const Spread forecast = spread_of(o.forecast);
    const Vector per_error = o.variance.cwiseSqrt().cwiseInverse();
    const double root = std::sqrt(static_cast<double>(o.forecast.cols() - 1));
    return {per_error.asDiagonal() * forecast.deviations / root,
            per_error.cwiseProduct(o.measured - forecast.mean)};
}

/// N x N: the inverse of the covariance of the analysis, in the space spanned by the members.
Matrix information_of(const Scaled& s) {
    const Eigen::Index n = s.deviations.cols();
    return Matrix::Identity(n, n) + s.deviations.transpose() * s.deviations;
}

/// The analysis in the space spanned by the members.
struct Transform {
    Vector mean;   // N: weights of the scaled deviations in the increment of the mean
    Matrix spread; // N x N, symmetric: turns deviations of the forecast into those of the analysis
};

Transform transform_of(const Scaled& s) {
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(information_of(s));
    const Matrix& axes = eigen.eigenvectors();
    const Vector inverse = eigen.eigenvalues().cwiseInverse();
    return {axes * inverse.asDiagonal() * axes.transpose() *
                (s.deviations.transpose() * s.innovation),
            axes * inverse.cwiseSqrt().asDiagonal() * axes.transpose()};
}

/// N x N: its product with deviations (n x N) gives the analysis relative to the forecast's mean.
Matrix weights_of(const Transform& t) {
    const double root = std::sqrt(static_cast<double>(t.mean.size() - 1));
    return t.spread.colwise() + t.mean / root;
}

} // namespace

void update_by_square_root(Matrix& members, const EnsembleObservation& observation) {
    check(members, observation);
    members = transformed(spread_of(members), weights_of(transform_of(scaled(observation))));
}

void update_by_perturbed_observations(Matrix& members, const EnsembleObservation& observation,
                                      Random& random) {
    check(members, observation);
    const Eigen::Index n = members.cols(), m = observation.measured.size();
    const Scaled s = scaled(observation);
    const double root = std::sqrt(static_cast<double>(n - 1));
    Matrix innovations(m, n); // in units of the measurement errors
    for (Eigen::Index j = 0; j < n; ++j)
        for (Eigen::Index k = 0; k < m; ++k) innovations(k, j) = random.normal();
    innovations.colwise() -= innovations.rowwise().mean().eval();
    innovations -= root * s.deviations;
    innovations.colwise() += s.innovation;
    members += spread_of(members).deviations / root *
               information_of(s).llt().solve(s.deviations.transpose() * innovations);
}

void update_locally(Matrix& members, const EnsembleObservation& observation,
                    const Matrix& weights) {
    check(members, observation);
    require(weights.rows() == members.rows() && weights.cols() == observation.measured.size() &&
                (weights.array() >= 0 && weights.array() <= 1).all(),
            fmt::format("ensemble update: expected {} x {} weights from 0 to 1, found {} x {}",
                        members.rows(), observation.measured.size(), weights.rows(),
                        weights.cols()));
    const Scaled s = scaled(observation);
    const Spread before = spread_of(members);
    const Eigen::Index m = observation.measured.size();
    for (Eigen::Index i = 0; i < members.rows(); ++i) {
        std::vector<Eigen::Index> near;
        std::vector<double> root_of_weight;
        for (Eigen::Index k = 0; k < m; ++k)
            if (const double w = weights(i, k); w > 0) {
                near.push_back(k);
                root_of_weight.push_back(std::sqrt(w));
            }
        if (near.empty()) continue;
        Scaled local{Matrix(near.size(), members.cols()), Vector(near.size())};
        for (std::size_t k = 0; k < near.size(); ++k) {
            const auto row = static_cast<Eigen::Index>(k);
            local.deviations.row(row) = root_of_weight[k] * s.deviations.row(near[k]);
            local.innovation[row] = root_of_weight[k] * s.innovation[near[k]];
        }
        members.row(i) = transformed({before.mean.segment(i, 1), before.deviations.row(i)},
                                     weights_of(transform_of(local)));
    }
}

double gaspari_cohn(double distance, double length) {
    const double r = std::abs(distance) / length;
    if (r >= 2) return 0;
    if (r <= 1) return 1 + r * r * (-5.0 / 3 + r * (5.0 / 8 + r * (0.5 - r / 4)));
    return 4 - 2 / (3 * r) + r * (-5 + r * (5.0 / 3 + r * (5.0 / 8 + r * (-0.5 + r / 12))));
}

void inflate(Matrix& members, double factor) {
    const Spread before = spread_of(members);
    members = (factor * before.deviations).colwise() + before.mean;
}

void rotate_randomly(Matrix& members, Random& random) {
    const Eigen::Index n = members.cols();
    // a random rotation of the N - 1 directions that are orthogonal to (1, ..., 1)
    Matrix draws(n - 1, n - 1), basis = Matrix::Identity(n, n);
    for (Eigen::Index c = 0; c < n - 1; ++c)
        for (Eigen::Index r = 0; r < n - 1; ++r) draws(r, c) = random.normal();
    const Eigen::HouseholderQR<Matrix> of_draws(draws);
    Matrix rotation = Matrix::Identity(n, n);
    // signs that make the distribution uniform (Mezzadri 2007)
    const Vector signs =
        of_draws.matrixQR().diagonal().unaryExpr([](double x) { return x < 0 ? -1.0 : 1.0; });
    rotation.bottomRightCorner(n - 1, n - 1) = of_draws.householderQ() * Matrix(signs.asDiagonal());
    basis.col(0).setOnes();
    const Matrix axes = Eigen::HouseholderQR<Matrix>(basis).householderQ();
    members = transformed(spread_of(members), axes * rotation * axes.transpose());
}

} // namespace bris

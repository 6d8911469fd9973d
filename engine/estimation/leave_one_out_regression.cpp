#include "engine/estimation/leave_one_out_regression.hpp"

#include "engine/errors.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

constexpr double mean_only = std::numeric_limits<double>::infinity();
constexpr int strengths_tried = 11;
// of the features' mean variance: added to the covariance of the distance, so that directions in
// which the samples do not vary count, but not without limit
constexpr double floor_of_variance = 0.01;

double strength_of(int k) { return std::pow(10.0, -2.5 + 0.5 * k); }

/// Parts of the singular directions that remain: s^2 / (s^2 + N lambda / 10).
Vector filter(const Vector& singular, double strength, double samples) {
    if (strength == mean_only) return Vector::Zero(singular.size());
    const Vector squares = singular.cwiseAbs2();
    return squares.cwiseQuotient((squares.array() + samples * strength / 10).matrix());
}

Vector columns_deviation(const Matrix& centred) {
    return (centred.colwise().squaredNorm() / static_cast<double>(centred.rows() - 1))
        .cwiseSqrt()
        .transpose();
}

} // namespace

LeaveOneOutRegression::LeaveOneOutRegression(const Matrix& features, const Vector& weights,
                                             const Matrix& targets, std::vector<TargetGroup> groups)
    : groups_(std::move(groups)) {
    const Eigen::Index n = features.rows();
    require(n >= 4, "regression: expected at least 4 samples");
    require(targets.rows() == n && weights.size() == features.cols(),
            "regression: expected as many rows of targets as of features, and a weight for each "
            "feature");
    Eigen::Index next = 0;
    for (const TargetGroup& g : groups_) {
        require(g.first == next && g.count > 0, "regression: expected groups that cover the "
                                                "targets in order");
        next += g.count;
    }
    require(next == targets.cols(), "regression: expected groups that cover all targets");

    feature_mean_ = features.colwise().mean().transpose();
    Matrix samples = features.rowwise() - feature_mean_.transpose();
    feature_scale_ = columns_deviation(samples);
    for (Eigen::Index k = 0; k < weights.size(); ++k) // a feature that never varies is left out
        feature_scale_[k] = feature_scale_[k] > 0 ? weights[k] / feature_scale_[k] : 0;
    samples = samples * feature_scale_.asDiagonal();
    target_mean_ = targets.colwise().mean().transpose();
    residuals_ = targets.rowwise() - target_mean_.transpose();
    target_deviation_ = columns_deviation(residuals_);

    const Eigen::JacobiSVD<Matrix> svd(samples, Eigen::ComputeThinU | Eigen::ComputeThinV);
    singular_ = svd.singularValues();
    basis_ = svd.matrixV();
    projected_ = svd.matrixU().transpose() * residuals_;
    choose_strengths(svd.matrixU(), singular_);
    rms_ = (residuals_.colwise().squaredNorm() / static_cast<double>(n)).cwiseSqrt().transpose();
    measure_distances(samples);
}

/// Chooses the strength of each group and replaces the centred targets in residuals_ by the
/// leave-one-out residuals. `left`: left singular vectors.
void LeaveOneOutRegression::choose_strengths(const Matrix& left, const Vector& singular) {
    const double n = static_cast<double>(left.rows());
    const Matrix squares = left.cwiseAbs2();
    for (const TargetGroup& g : groups_) {
        const Matrix centred = residuals_.middleCols(g.first, g.count);
        const Matrix projected = projected_.middleCols(g.first, g.count);
        const Vector scale = target_deviation_.segment(g.first, g.count).unaryExpr([](double d) {
            return d > 0 ? 1 / d : 0.0;
        });
        double best = (centred * scale.asDiagonal()).squaredNorm() / std::pow(1 - 1 / n, 2);
        strengths_.push_back(mean_only);
        mean_leverage_.push_back(1 / n);
        residuals_.middleCols(g.first, g.count) = centred / (1 - 1 / n);
        for (int k = 0; k < strengths_tried; ++k) {
            const Vector kept = filter(singular, strength_of(k), n);
            const Vector leverage = (squares * kept).array() + 1 / n;
            const Matrix residual = (1 - leverage.array()).inverse().matrix().asDiagonal() *
                                    (centred - left * (kept.asDiagonal() * projected));
            const double sum = (residual * scale.asDiagonal()).squaredNorm();
            if (!(sum < best)) continue;
            best = sum;
            strengths_.back() = strength_of(k);
            mean_leverage_.back() = leverage.mean();
            residuals_.middleCols(g.first, g.count) = residual;
        }
    }
}

void LeaveOneOutRegression::measure_distances(const Matrix& samples) {
    const Eigen::Index n = samples.rows(), p = samples.cols();
    const Matrix sum = samples.transpose() * samples;
    const double level = std::max(floor_of_variance * sum.trace() /
                                      static_cast<double>(n * std::max<Eigen::Index>(1, p)),
                                  1e-300);
    const auto inverse = [&](const Matrix& squares, Eigen::Index count) {
        const Matrix covariance =
            squares / static_cast<double>(count - 1) + level * Matrix::Identity(p, p);
        return Matrix(covariance.llt().solve(Matrix::Identity(p, p)));
    };
    std::vector<double> distances;
    for (Eigen::Index i = 0; i < n; ++i) { // each from the mean and covariance of the others
        const double others = static_cast<double>(n - 1);
        const Vector x = samples.row(i).transpose(), mean = -x / others; // the mean of all is 0
        const Matrix squares = sum - x * x.transpose() - others * mean * mean.transpose();
        distances.push_back(std::sqrt((x - mean).dot(inverse(squares, n - 1) * (x - mean))));
    }
    std::ranges::sort(distances);
    inverse_covariance_ = inverse(sum, n);
    usual_distance_ =
        std::max(distances[static_cast<std::size_t>(0.95 * static_cast<double>(n - 1))], 1e-300);
}

Vector LeaveOneOutRegression::standardised(const Vector& features) const {
    require(features.size() == feature_mean_.size(),
            "regression: expected as many features as the samples have");
    require(features.allFinite(), "regression: expected features that are numbers");
    return (features - feature_mean_).cwiseProduct(feature_scale_);
}

double LeaveOneOutRegression::distance(const Vector& x) const {
    return std::sqrt(x.dot(inverse_covariance_ * x)) / usual_distance_;
}

LeaveOneOutRegression::Prediction LeaveOneOutRegression::predict(const Vector& features) const {
    const Vector x = standardised(features);
    const Vector z = basis_.transpose() * x;
    const double n = freedom() + 1;
    Prediction p{target_mean_, rms_, distance(x)};
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const auto [first, count] = groups_[g];
        double leverage = 1 / n;
        if (strengths_[g] != mean_only) {
            // x is U S V^T of a sample: z / s are its coordinates among the left singular vectors
            Vector coefficient(z.size());
            for (Eigen::Index k = 0; k < z.size(); ++k) {
                const double sum = singular_[k] * singular_[k] + n * strengths_[g] / 10;
                coefficient[k] = singular_[k] * z[k] / sum;
                leverage += z[k] * z[k] / sum;
            }
            p.mean.segment(first, count) +=
                projected_.middleCols(first, count).transpose() * coefficient;
        }
        p.deviation.segment(first, count) *=
            std::sqrt(std::max(1.0, (1 + leverage) / (1 + mean_leverage_[g]))) *
            std::max(1.0, p.distance);
    }
    return p;
}

LeaveOneOutRegression::Prediction LeaveOneOutRegression::prior() const {
    return {target_mean_, target_deviation_ * std::sqrt(1 + 1 / (freedom() + 1)), 0};
}

} // namespace bris

#include "engine/estimation/hybrid_regression.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double share_of_samples = 0.1, fewest_effective = 4;

Vector weights_at(const Vector& above_nearest, double temperature) {
    const Vector w = (-0.5 / temperature * above_nearest.array()).exp();
    return w / w.sum();
}

/// Root mean squares of the columns.
Vector root_mean_squares(const Matrix& m) {
    return (m.colwise().squaredNorm() / static_cast<double>(m.rows())).cwiseSqrt().transpose();
}

} // namespace

Vector tempered_weights(const Vector& squared_distances, double effective) {
    const auto n = static_cast<double>(squared_distances.size());
    require(squared_distances.allFinite(), "weights of samples: expected distances that are "
                                           "numbers");
    require(effective >= 1 && effective <= n, "weights of samples: expected an effective number "
                                              "from 1 to that of the samples");
    const Vector above = squared_distances.array() - squared_distances.minCoeff();
    const double largest = above.maxCoeff();
    if (!(largest > 0)) return Vector::Constant(squared_distances.size(), 1 / n);
    // the effective number grows with the temperature: bisection of its logarithm
    double cold = std::log(1e-9 * largest), hot = std::log(1e9 * largest);
    for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (cold + hot);
        const double counts = 1 / weights_at(above, std::exp(middle)).squaredNorm();
        (counts < effective ? cold : hot) = middle;
    }
    return weights_at(above, std::exp(hot));
}

HybridRegression::HybridRegression(const Matrix& features, const Vector& weights,
                                   const Matrix& targets, std::vector<TargetGroup> groups)
    : groups_(groups), regression_(features, weights, targets, std::move(groups)),
      samples_(features.rows(), features.cols()), targets_(targets),
      effective_(std::max(share_of_samples * static_cast<double>(features.rows()),
                          std::min(fewest_effective, static_cast<double>(features.rows() - 1)))),
      residuals_(regression_.residuals()) {
    for (Eigen::Index i = 0; i < features.rows(); ++i)
        samples_.row(i) = regression_.standardised(features.row(i).transpose()).transpose();
    const Matrix of_weights = residuals_of_weights();
    const Vector variance =
        (targets.rowwise() - targets.colwise().mean()).colwise().squaredNorm().transpose();
    for (const TargetGroup& g : groups_) {
        // the share s that makes (1 - s) r + s w smallest, each target relative to its variance
        auto r = residuals_.middleCols(g.first, g.count);
        const auto w = of_weights.middleCols(g.first, g.count);
        double with_r = 0, with_itself = 0;
        for (Eigen::Index t = 0; t < g.count; ++t) {
            if (!(variance[g.first + t] > 0)) continue;
            const Vector off = r.col(t) - w.col(t);
            with_r += r.col(t).dot(off) / variance[g.first + t];
            with_itself += off.squaredNorm() / variance[g.first + t];
        }
        shares_.push_back(with_itself > 0 ? std::clamp(with_r / with_itself, 0.0, 1.0) : 0);
        r = (1 - shares_.back()) * r + shares_.back() * w;
    }
    const Vector rms = root_mean_squares(residuals_),
                 of_regression = root_mean_squares(regression_.residuals());
    deviation_ratio_ = (of_regression.array() > 0)
                           .select(rms.array() / of_regression.array().max(1e-300), 1.0)
                           .matrix();
}

Vector HybridRegression::distances_to(const Vector& standardised) const {
    return (samples_.rowwise() - standardised.transpose()).rowwise().squaredNorm();
}

Matrix HybridRegression::residuals_of_weights() const {
    const Eigen::Index n = samples_.rows();
    Matrix weights = Matrix::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const Vector all = distances_to(samples_.row(i).transpose());
        Vector others(n - 1);
        others << all.head(i), all.tail(n - 1 - i);
        const Vector w = tempered_weights(others, std::min(effective_, static_cast<double>(n - 1)));
        weights.row(i).head(i) = w.head(i).transpose();
        weights.row(i).tail(n - 1 - i) = w.tail(n - 1 - i).transpose();
    }
    return targets_ - weights * targets_;
}

Vector HybridRegression::sample_weights(const Vector& features) const {
    return tempered_weights(distances_to(regression_.standardised(features)), effective_);
}

HybridRegression::Prediction HybridRegression::predict(const Vector& features) const {
    Prediction p = regression_.predict(features);
    const Vector of_weights = targets_.transpose() * sample_weights(features);
    const double trust = 1 / std::pow(std::max(1.0, p.distance), 2);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const auto [first, count] = groups_[g];
        const double share = 1 - (1 - shares_[g]) * trust;
        auto mean = p.mean.segment(first, count);
        mean = (1 - share) * mean + share * of_weights.segment(first, count);
    }
    p.deviation = p.deviation.cwiseProduct(deviation_ratio_);
    return p;
}

} // namespace bris

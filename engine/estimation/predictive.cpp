#include "engine/estimation/predictive.hpp"

#include "engine/errors.hpp"
#include "engine/estimation/student_t.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace bris {

namespace {

double mean_of(std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double products(std::span<const double> a, std::span<const double> b) {
    const double mean_a = mean_of(a), mean_b = mean_of(b);
    double sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - mean_a) * (b[k] - mean_b);
    return sum;
}

} // namespace

double Predictive::probability_above(double value) const {
    return student_t_probability((centre - value) / scale, degrees);
}

double Predictive::quantile(double probability) const {
    return centre + scale * student_t_quantile(probability, degrees);
}

Predictive predict_by_mean(std::span<const double> values) {
    const auto n = static_cast<double>(values.size());
    require(n >= 3, "predictive: expected at least 3 values");
    const double variance = products(values, values) / (n - 1);
    require(variance > 0, "predictive: expected values that differ");
    return {mean_of(values), std::sqrt(variance * (1 + 1 / n)), n - 1};
}

Predictive predict_by_line(std::span<const double> x, std::span<const double> y, double measured,
                           double deviation) {
    const auto n = static_cast<double>(x.size());
    require(n >= 4 && x.size() == y.size() && deviation >= 0,
            "predictive: expected at least 4 points and an error of at least 0");
    const double xx = products(x, x), mean = mean_of(x);
    require(xx > 0, "predictive: expected points with different x");
    const double slope = products(x, y) / xx,
                 rest = std::max(0.0, products(y, y) - slope * products(x, y)) / (n - 2);
    const double prior = xx / (n - 1), error = deviation * deviation,
                 weight = prior / (prior + error), at = mean + weight * (measured - mean);
    const double leverage = 1 / n + (at - mean) * (at - mean) / xx;
    const double variance = rest * (1 + leverage) + slope * slope * weight * error;
    require(variance > 0, "predictive: expected points that do not lie on one line");
    return {mean_of(y) + slope * (at - mean), std::sqrt(variance), n - 2};
}

} // namespace bris

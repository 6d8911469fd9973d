#include "scenarios/monitoring/comparison.hpp"

#include "engine/estimation/student_t.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double heavy = 4; // degrees of freedom of the tails, less one for each value
constexpr double share_of_level = 0.5;
constexpr double most_degrees = 1e6;

} // namespace

double p_of_deviation(double t, double degrees, double values) {
    if (!std::isfinite(t)) return std::isnan(t) ? t : 0;
    const double tails = heavy + values, scale = std::sqrt((tails - 2) / tails);
    return std::min(1.0, 2 * std::max(student_t_probability(-std::abs(t), degrees),
                                      student_t_probability(-std::abs(t) / scale, tails)));
}

double deviation_of_p(double p, double degrees, double values) {
    const double tails = heavy + values, scale = std::sqrt((tails - 2) / tails);
    return -std::min(student_t_quantile(p / 2, degrees), scale * student_t_quantile(p / 2, tails));
}

std::vector<double> shares_of(const std::vector<bool>& is_judged, std::size_t sensors) {
    const auto judged = std::ranges::count(is_judged, true);
    std::vector<double> shares(is_judged.size(), 0.0);
    const double own = 1 / static_cast<double>(sensors),
                 first = is_judged.front() ? judged > 1 ? share_of_level : 1 : 0,
                 others = static_cast<double>(judged - (is_judged.front() ? 1 : 0));
    for (std::size_t f = 0; f < is_judged.size(); ++f)
        if (is_judged[f]) shares[f] = own * (f == 0 ? first : (1 - first) / others);
    return shares;
}

std::vector<bool> rejected(const std::vector<double>& p, const std::vector<double>& shares,
                           double false_alarms) {
    std::vector<std::size_t> order;
    double left = 0; // shares of what is not rejected so far
    for (std::size_t k = 0; k < p.size(); ++k) {
        if (shares[k] > 0) left += shares[k];
        if (shares[k] > 0 && !std::isnan(p[k])) order.push_back(k);
    }
    std::ranges::sort(order, {}, [&](std::size_t k) { return p[k] / shares[k]; });
    std::vector<bool> is_rejected(p.size(), false);
    for (const std::size_t k : order) {
        if (!(p[k] <= false_alarms * shares[k] / std::max(left, shares[k]))) break;
        is_rejected[k] = true;
        left -= shares[k];
    }
    return is_rejected;
}

double seen_in_90_per_cent(const ExpectedFeature& expected, double p, double values) {
    return (deviation_of_p(p, expected.degrees, values) + student_t_quantile(0.9, most_degrees)) *
           expected.deviation();
}

Trend trend_of(const std::vector<double>& deviations, const ExpectedFeature& expected,
               double serial, double between) {
    Trend trend;
    std::vector<double> z, at;
    for (std::size_t k = 0; k < deviations.size(); ++k) {
        if (!std::isfinite(deviations[k])) continue;
        z.push_back(deviations[k]);
        at.push_back(static_cast<double>(k + 1));
    }
    trend.passages = z.size();
    if (z.size() < 2 || !expected.is_known()) return trend;
    double squares = 0, fourths = 0, sum = 0;
    for (const double i : at) {
        squares += i * i;
        fourths += i * i * i * i;
        sum += i;
    }
    std::vector<double> covariance(deviations.size()); // by lag
    for (std::size_t lag = 0; lag < covariance.size(); ++lag)
        covariance[lag] = (std::pow(serial, static_cast<double>(lag)) + between) / (1 + between);
    const auto n = static_cast<double>(z.size());
    double of_mean = 0, of_slope = 0; // variances
    for (std::size_t i = 0; i < z.size(); ++i) {
        trend.mean += z[i] / n;
        trend.slope += at[i] * z[i] / squares;
        for (std::size_t j = 0; j < z.size(); ++j) {
            const double c = covariance[static_cast<std::size_t>(std::abs(at[i] - at[j]))];
            of_mean += c / (n * n);
            of_slope += c * at[i] * at[j] / (squares * squares);
        }
    }
    trend.variance = of_mean;
    trend.p_mean =
        p_of_deviation(trend.mean / std::sqrt(of_mean + expected.of_mean), expected.degrees, n);
    trend.p_slope = p_of_deviation(
        trend.slope / std::sqrt(of_slope + sum * sum / (squares * squares) * expected.of_mean),
        expected.degrees, squares * squares / fourths);
    double by_mean = 0, by_slope = 0, after = 0, before = 0;
    for (std::size_t i = 0; i < z.size(); ++i) {
        by_mean += (z[i] - trend.mean) * (z[i] - trend.mean);
        by_slope += (z[i] - trend.slope * at[i]) * (z[i] - trend.slope * at[i]);
        before += z[i] * z[i];
    }
    double by_step = before, squares_after = 0; // 0 before the step, the mean after it
    for (std::size_t i = z.size(); i-- > 0;) {
        after += z[i];
        squares_after += z[i] * z[i];
        before -= z[i] * z[i];
        const double count = static_cast<double>(z.size() - i);
        by_step = std::min(by_step, before + squares_after - after * after / count);
    }
    constexpr std::size_t fewest = 5; // passages that tell a slope from a step
    constexpr double for_place = 4;   // what a step must gain, since it may be anywhere
    trend.is_slope = z.size() >= fewest && by_slope < by_mean && by_slope < by_step + for_place;
    return trend;
}

std::vector<TestOfRun> tests_of_run(const std::vector<double>& deviations,
                                    const std::vector<double>& p, const ExpectedFeature& expected,
                                    double serial, double between, bool only_above, double share) {
    using enum TestOfRun::Kind;
    const auto trend_from = [&](std::size_t first) {
        Trend trend =
            trend_of({deviations.begin() + static_cast<std::ptrdiff_t>(first), deviations.end()},
                     expected, serial, between);
        if (only_above && trend.mean < 0) trend.p_mean = 1;
        if (only_above && trend.slope < 0) trend.p_slope = 1;
        return trend;
    };
    std::vector<TestOfRun> tests;
    const Trend whole = trend_from(0);
    const bool has_trend = whole.passages > 1;
    if (has_trend) {
        tests.push_back({mean, 0, whole.p_mean, share / 4, whole});
        tests.push_back({slope, 0, whole.p_slope, share / 4, whole});
    }
    std::vector<std::size_t> firsts; // of the last ones
    for (std::size_t last = 2; last < deviations.size(); last *= 2)
        firsts.push_back(deviations.size() - last);
    for (const std::size_t first : firsts) {
        const Trend last = trend_from(first);
        tests.push_back(
            {recent, first, last.p_mean, share / 4 / static_cast<double>(firsts.size()), last});
    }
    const double each = (has_trend ? share / 4 : share) /
                        static_cast<double>(std::max<std::size_t>(1, whole.passages));
    for (std::size_t k = 0; k < p.size(); ++k)
        if (std::isfinite(p[k])) tests.push_back({passage, k, p[k], each, {}});
    return tests;
}

} // namespace bris

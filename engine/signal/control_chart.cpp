#include "engine/signal/control_chart.hpp"

#include "engine/errors.hpp"
#include "engine/math.hpp"
#include "engine/signal/autoregression.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace bris {

namespace {

double real(std::size_t n) { return static_cast<double>(n); }

double normal_distribution(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

/// Moments of the range R of n standard normal values, from P(R <= r) = n int phi(x) (Phi(x + r) -
/// Phi(x))^(n-1) dx: E R = int P(R > r) dr, E R^2 = 2 int r P(R > r) dr, by Simpson's rule in r and
/// the trapezium rule in x, which is exact to rounding for functions that vanish at both ends.
struct RangeMoments {
    double mean, square;
};

RangeMoments range_moments(std::size_t n) {
    constexpr double step = 0.02, end = 9, longest = 14;
    constexpr auto half = static_cast<std::size_t>(end / step),
                   last = static_cast<std::size_t>(longest / step);
    std::vector<double> below; // Phi at -end, -end + step ...
    for (std::size_t k = 0; k <= 2 * half + last; ++k)
        below.push_back(normal_distribution(step * real(k) - end));
    const auto power = static_cast<double>(n - 1);
    RangeMoments moments{0, 0};
    for (std::size_t r = 0; r <= last; ++r) {
        double within = 0;
        for (std::size_t k = 0; k <= 2 * half; ++k) {
            const double x = step * real(k) - end;
            within += std::exp(-0.5 * x * x) * std::pow(below[k + r] - below[k], power);
        }
        within *= real(n) * step / std::sqrt(2 * pi);
        const double weight = (r == 0 || r == last ? 1 : r % 2 == 1 ? 4 : 2) * step / 3;
        moments.mean += weight * (1 - within);
        moments.square += weight * 2 * step * real(r) * (1 - within);
    }
    return moments;
}

/// Calls visit(values) for each subgroup of n successive values.
template <class Visit>
void for_subgroups(Runs runs, std::size_t n, Visit&& visit) {
    for (const auto& run : runs)
        for (std::size_t begin = 0; begin + n <= run.size(); begin += n)
            visit(std::span<const double>(run).subspan(begin, n));
}

double mean_of(std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / real(values.size());
}

double deviation_of(std::span<const double> values) {
    const double mean = mean_of(values);
    double squares = 0;
    for (const double x : values) squares += (x - mean) * (x - mean);
    return std::sqrt(squares / real(values.size() - 1));
}

} // namespace

ChartConstants chart_constants(std::size_t n) {
    require(n >= 2 && n <= 100,
            fmt::format("control chart: expected subgroups of 2 to 100, found {}", n));
    const double size = real(n);
    ChartConstants c{};
    c.c4 =
        std::sqrt(2 / (size - 1)) * std::exp(std::lgamma(size / 2) - std::lgamma((size - 1) / 2));
    const RangeMoments range = range_moments(n);
    c.d2 = range.mean;
    c.d3 = std::sqrt(range.square - range.mean * range.mean);
    c.A2 = 3 / (c.d2 * std::sqrt(size));
    c.A3 = 3 / (c.c4 * std::sqrt(size));
    const double of_deviation = 3 * std::sqrt(1 - c.c4 * c.c4) / c.c4, of_range = 3 * c.d3 / c.d2;
    c.B3 = std::max(0.0, 1 - of_deviation);
    c.B4 = 1 + of_deviation;
    c.D3 = std::max(0.0, 1 - of_range);
    c.D4 = 1 + of_range;
    return c;
}

std::vector<double> subgroup_means(Runs runs, std::size_t n) {
    std::vector<double> means;
    for_subgroups(runs, n,
                  [&](std::span<const double> values) { means.push_back(mean_of(values)); });
    return means;
}

std::vector<double> subgroup_deviations(Runs runs, std::size_t n) {
    require(n >= 2, "control chart: expected subgroups of at least 2");
    std::vector<double> deviations;
    for_subgroups(runs, n, [&](std::span<const double> values) {
        deviations.push_back(deviation_of(values));
    });
    return deviations;
}

ControlChart mean_chart(Runs baseline, std::size_t n, double width, ControlLimits limits) {
    require(n >= 2, "control chart: expected subgroups of at least 2");
    std::vector<double> all;
    for (const auto& run : baseline) all.insert(all.end(), run.begin(), run.end());
    require(all.size() >= n,
            fmt::format("control chart: expected at least one subgroup of {}, found {} values", n,
                        all.size()));
    const double factor = limits == ControlLimits::independent
                              ? 1
                              : variance_factor_of_mean(autocorrelations(baseline, n - 1), n);
    const ControlChart chart{mean_of(all), deviation_of(all) * std::sqrt(factor / real(n)), width};
    require(chart.deviation > 0,
            "control chart: expected a baseline that varies, found a constant one");
    return chart;
}

ControlChart deviation_chart(Runs baseline, std::size_t n, double width) {
    std::vector<double> logarithms;
    for (const double s : subgroup_deviations(baseline, n))
        if (s > 0) logarithms.push_back(std::log(s));
    const double deviation = logarithms.size() < 2 ? 0 : deviation_of(logarithms);
    require(deviation > 0,
            fmt::format("control chart: expected at least two subgroups of {} that vary, found {}",
                        n, logarithms.size()));
    return {mean_of(logarithms), deviation, width};
}

} // namespace bris

#include "scenarios/monitoring/downward_acceleration.hpp"

#include "engine/signal/spectrum.hpp"
#include "scenarios/monitoring/vibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double longest_gap = 0.05; // s
constexpr double rest = 0.1;         // s, that gives the direction of gravity

/// s, of the longest gap between runs.
double gap_in(const Vibration& v) {
    double longest = 0;
    for (std::size_t r = 1; r < v.runs.size(); ++r)
        longest = std::max(longest, v.begins[r] - v.begins[r - 1] -
                                        static_cast<double>(v.runs[r - 1].size() - 1) / v.rate);
    return longest;
}

/// All runs as one series; samples between them lie on straight lines.
std::vector<double> joined(const Vibration& v) {
    std::vector<double> series;
    for (std::size_t r = 0; r < v.runs.size(); ++r) {
        const auto begin = static_cast<std::size_t>(
            std::max(0LL, std::llround((v.begins[r] - v.begins.front()) * v.rate)));
        const std::size_t before = series.size();
        for (std::size_t k = before; k < begin; ++k) {
            const double part =
                static_cast<double>(k - before + 1) / static_cast<double>(begin - before + 1);
            series.push_back(series[before - 1] + part * (v.runs[r].front() - series[before - 1]));
        }
        series.insert(series.end(), v.runs[r].begin(), v.runs[r].end());
    }
    return series;
}

/// The recording with its specific force in the axes that the rock had at the beginning, by its
/// angular rates less their mean at rest: a rock that tilts turns gravity into its other axes.
Recording turned_back(Recording r) {
    if (r.rate.size() < 2 || r.force.empty()) return r;
    Vec3 bias = Vec3::Zero();
    double samples = 0;
    for (std::size_t k = 0; k < r.size() && r.time[k] <= r.time.front() + rest; ++k, ++samples)
        bias += r.rate[k];
    bias /= samples;
    Quat turned = Quat::Identity();
    for (std::size_t k = 1; k < r.size(); ++k) {
        const Vec3 rate = 0.5 * (r.rate[k] + r.rate[k - 1]) - bias;
        turned = turned * exponential_map((r.time[k] - r.time[k - 1]) * rate);
        r.force[k] = turned * r.force[k];
    }
    return r;
}

std::string reason_against(const Vibration& v, double passing_time, double lowest) {
    if (!v.impossible_because.empty()) return v.impossible_because;
    if (v.saturated > 0)
        return fmt::format("{:.2g} % of the samples are at the end of the range",
                           100 * v.saturated);
    if (const double gap = gap_in(v); gap > longest_gap)
        return fmt::format("a gap of {:.2g} s", gap);
    for (const auto& run : v.runs)
        if (!std::ranges::all_of(run, [](double a) { return std::isfinite(a); }))
            return "a sample that is no number";
    const double needed = std::max(2 / lowest, 0.95 * passing_time);
    if (v.duration >= needed) return {};
    return fmt::format("{:.3g} s are too short, the train needs {:.3g} s", v.duration, needed);
}

} // namespace

DownwardAcceleration downward_acceleration(const Recording& recording, double passing_time,
                                           double lowest) {
    const Vibration v = vibration_of(turned_back(recording), VibrationQuantity::vertical, rest);
    DownwardAcceleration down{.rate = v.rate, .duration = v.duration};
    down.impossible_because = reason_against(v, passing_time, lowest);
    if (!down.impossible_because.empty()) return down;
    down.series = joined(v);
    detrend(down.series, Detrend::line);
    for (double& a : down.series) a = -a;
    return down;
}

} // namespace bris

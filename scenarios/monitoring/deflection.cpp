#include "scenarios/monitoring/deflection.hpp"

#include "engine/signal/displacement.hpp"
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

double fall_of(const std::vector<double>& series) {
    constexpr double turn = 0.25; // of the range, a rise that ends a fall
    const auto [low, high] = std::ranges::minmax(series);
    return largest_fall(series, turn * (high - low));
}

/// Fall of a displacement in proportion to the load over what is found of it.
double lost_factor(const LoadHistory& load, double rate, double lowest) {
    std::vector<double> series; // beginning and ending at rest
    const double duration = load.times.back();
    for (double t = -1 / lowest; t < duration + 1 / lowest; t += 1 / rate)
        series.push_back(load.values.front() - std::max(0.0, load.at(t)));
    return fall_of(series) / fall_of(without_slow_motion(series, rate, lowest));
}

} // namespace

RecordedDeflection deflection_of(const Recording& recording, const LoadHistory& load,
                                 double lowest) {
    constexpr double nonlinear = 0.05; // of the deflection, standard deviation
    RecordedDeflection found;
    const Vibration v = vibration_of(recording, "vertical", rest);
    const double gap = gap_in(v);
    if (!v.impossible_because.empty())
        found.impossible_because = v.impossible_because;
    else if (v.saturated > 0)
        found.impossible_because =
            fmt::format("{:.2g} % of the samples are at the end of the range", 100 * v.saturated);
    else if (gap > longest_gap)
        found.impossible_because = fmt::format("a gap of {:.2g} s", gap);
    else if (const double needed = std::max(2 / lowest, 0.95 * load.times.back());
             v.duration < needed)
        found.impossible_because =
            fmt::format("{:.3g} s are too short, the train needs {:.3g} s", v.duration, needed);
    if (!found.impossible_because.empty()) return found;
    const auto displacement = displacement_of(joined(v), v.rate, lowest);
    const double factor = lost_factor(load, v.rate, lowest);
    found.largest = factor * fall_of(displacement);
    found.deviation = std::hypot(nonlinear * found.largest,
                                 factor * std::sqrt(2.0) *
                                     displacement_noise(recording.info.force_noise, lowest));
    return found;
}

} // namespace bris

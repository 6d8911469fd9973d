#include "scenarios/monitoring/vibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

Vec3 mean_of(const std::vector<Vec3>& values, std::size_t count) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < count; ++k) sum += values[k];
    return sum / static_cast<double>(std::max<std::size_t>(1, count));
}

/// The quantity at each sample of the recording.
std::vector<double> series_of(const Recording& r, VibrationQuantity quantity, double rest) {
    std::vector<double> series;
    if (quantity == VibrationQuantity::vertical) {
        const auto still = static_cast<std::size_t>(
            std::ranges::count_if(r.time, [&](double t) { return t <= r.time.front() + rest; }));
        const Vec3 at_rest = mean_of(r.force, still), up = at_rest.normalized();
        for (const Vec3& f : r.force) series.push_back(f.dot(up) - at_rest.norm());
        return series;
    }
    const Eigen::Index axis = axis_of(quantity);
    const Vec3 bias = mean_of(r.rate, r.rate.size());
    for (const Vec3& w : r.rate) series.push_back((r.info.attitude() * Vec3(w - bias))[axis]);
    return series;
}

bool follows(const Recording& r, std::size_t k) {
    const bool in_time = r.time[k] - r.time[k - 1] < 1.5 / r.info.sampling_rate;
    return in_time && (r.sequence.empty() || r.sequence[k] == r.sequence[k - 1] + 1);
}

} // namespace

const std::vector<std::string>& texts_of(VibrationQuantity) {
    static const std::vector<std::string> texts{"vertical", "roll_rate", "pitch_rate", "yaw_rate"};
    return texts;
}

Eigen::Index axis_of(VibrationQuantity rate) {
    return rate == VibrationQuantity::roll_rate ? 0 : rate == VibrationQuantity::pitch_rate ? 1 : 2;
}

Vibration vibration_of(const Recording& r, VibrationQuantity quantity, double rest) {
    Vibration v{.rate = r.info.sampling_rate};
    const bool by_force = quantity == VibrationQuantity::vertical;
    const auto& source = by_force ? r.force : r.rate;
    if (r.size() < 2 || source.empty()) {
        v.impossible_because = r.size() < 2 ? "no samples"
                               : by_force   ? "no acceleration was recorded (ax ay az)"
                                            : "no angular rate was recorded (gx gy gz)";
        return v;
    }
    v.duration = r.time.back() - r.time.front();
    v.missing = std::max(0.0, 1 - static_cast<double>(r.size() - 1) / (v.duration * v.rate));
    v.measured_rate = static_cast<double>(r.size() - 1) / v.duration;
    const double range = by_force ? r.info.force_range : r.info.rate_range;
    v.saturated =
        static_cast<double>(std::ranges::count_if(
            source, [&](const Vec3& x) { return x.cwiseAbs().maxCoeff() >= 0.999 * range; })) /
        static_cast<double>(r.size());
    const std::vector<double> series = series_of(r, quantity, rest);
    double mean = 0, squares = 0;
    for (std::size_t k = 0; k < series.size(); ++k) {
        if (k == 0 || !follows(r, k)) {
            v.runs.emplace_back();
            v.begins.push_back(r.time[k]);
            v.firsts.push_back(k);
        }
        v.runs.back().push_back(series[k]);
        mean += series[k] / static_cast<double>(series.size());
    }
    for (const double x : series) squares += (x - mean) * (x - mean);
    v.rms = std::sqrt(squares / static_cast<double>(series.size()));
    return v;
}

namespace {

constexpr double window = 0.25; // s
constexpr double bridged = 0.5; // s of quiet within a train

/// Root mean squares of successive windows of a run; the last one may be longer.
struct Window {
    SampleRange samples;
    double rms;
};
std::vector<Window> windows_of(const Vibration& v) {
    const auto length = static_cast<std::size_t>(std::max(1.0, std::round(window * v.rate)));
    std::vector<Window> windows;
    for (std::size_t r = 0; r < v.runs.size(); ++r)
        for (std::size_t begin = 0; begin < v.runs[r].size(); begin += length) {
            const std::size_t end = std::min(begin + length, v.runs[r].size());
            double squares = 0;
            for (std::size_t k = begin; k < end; ++k) squares += v.runs[r][k] * v.runs[r][k];
            windows.push_back({{v.firsts[r] + begin, v.firsts[r] + end},
                               std::sqrt(squares / static_cast<double>(end - begin))});
        }
    return windows;
}

} // namespace

std::vector<SampleRange> active_ranges(const Vibration& v, double presence, double share) {
    const std::vector<Window> windows = windows_of(v);
    std::vector<double> above;
    for (const Window& w : windows)
        if (w.rms > presence) above.push_back(w.rms);
    if (above.empty()) return {};
    const auto loud = above.begin() + static_cast<std::ptrdiff_t>(9 * (above.size() - 1) / 10);
    std::ranges::nth_element(above, loud);
    const auto most = static_cast<std::size_t>(bridged * v.rate);
    std::vector<SampleRange> ranges;
    for (const Window& w : windows) {
        if (!(w.rms > share * *loud)) continue;
        const bool in_one_run = std::ranges::none_of(v.firsts, [&](std::size_t first) {
            return !ranges.empty() && first >= ranges.back().end && first <= w.samples.begin;
        });
        if (!ranges.empty() && in_one_run && w.samples.begin - ranges.back().end <= most)
            ranges.back().end = w.samples.end;
        else
            ranges.push_back(w.samples);
    }
    return ranges;
}

std::vector<SampleRange> whole_ranges(const Vibration& v) {
    std::vector<SampleRange> ranges;
    for (std::size_t r = 0; r < v.runs.size(); ++r)
        ranges.push_back({v.firsts[r], v.firsts[r] + v.runs[r].size()});
    return ranges;
}

std::vector<std::vector<double>> runs_in(const Vibration& v,
                                         const std::vector<SampleRange>& ranges) {
    std::vector<std::vector<double>> runs;
    std::size_t r = 0;
    for (const SampleRange& range : ranges) {
        while (range.begin >= v.firsts[r] + v.runs[r].size()) ++r;
        const auto at = [&](std::size_t k) {
            return v.runs[r].begin() + static_cast<std::ptrdiff_t>(k - v.firsts[r]);
        };
        runs.emplace_back(at(range.begin), at(range.end));
    }
    return runs;
}

Moments moments_of(std::span<const std::vector<double>> runs) {
    double sum = 0, n = 0, squares = 0;
    for (const auto& run : runs)
        for (const double x : run) sum += x, ++n;
    for (const auto& run : runs)
        for (const double x : run) squares += (x - sum / n) * (x - sum / n);
    return {sum / n, squares / n};
}

double rate_per_force(const Recording& r) {
    const auto squares = [](const std::vector<Vec3>& values) {
        const Vec3 mean = mean_of(values, values.size());
        double sum = 0;
        for (const Vec3& v : values) sum += (v - mean).squaredNorm();
        return sum;
    };
    if (r.rate.empty() || r.force.empty()) return std::numeric_limits<double>::quiet_NaN();
    const double of_rate = squares(r.rate), of_force = squares(r.force);
    return of_rate > 0 && of_force > 0 ? std::sqrt(of_rate / of_force)
                                       : std::numeric_limits<double>::quiet_NaN();
}

} // namespace bris

#include "scenarios/monitoring/vibration.hpp"

#include "engine/signal/spectrum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

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
        }
        v.runs.back().push_back(series[k]);
        mean += series[k] / static_cast<double>(series.size());
    }
    for (const double x : series) squares += (x - mean) * (x - mean);
    v.rms = std::sqrt(squares / static_cast<double>(series.size()));
    return v;
}

Vibration passing_part(const Vibration& whole, double threshold) {
    struct Part {
        std::size_t run, begin, end;
        bool active;
    };
    const auto length = static_cast<std::size_t>(std::max(1.0, std::round(0.25 * whole.rate)));
    std::vector<Part> windows;
    for (std::size_t r = 0; r < whole.runs.size(); ++r)
        for (std::size_t begin = 0; begin < whole.runs[r].size(); begin += length) {
            const std::size_t end = std::min(begin + length, whole.runs[r].size());
            double squares = 0;
            for (std::size_t k = begin; k < end; ++k)
                squares += whole.runs[r][k] * whole.runs[r][k];
            windows.push_back({r, begin, end,
                               squares > threshold * threshold * static_cast<double>(end - begin)});
        }
    const auto first = std::ranges::find_if(windows, &Part::active);
    const auto last =
        std::find_if(windows.rbegin(), windows.rend(), [](const Part& w) { return w.active; });
    Vibration part = whole;
    part.runs.clear();
    part.begins.clear();
    double squares = 0;
    std::size_t samples = 0;
    for (auto w = first; w < last.base(); ++w) {
        const auto& run = whole.runs[w->run];
        if (w == first || (w - 1)->run != w->run) {
            part.runs.emplace_back();
            part.begins.push_back(whole.begins[w->run] +
                                  static_cast<double>(w->begin) / whole.rate);
        }
        for (std::size_t k = w->begin; k < w->end; ++k) {
            part.runs.back().push_back(run[k]);
            squares += run[k] * run[k];
        }
        samples += w->end - w->begin;
    }
    part.rms = samples > 0 ? std::sqrt(squares / static_cast<double>(samples)) : 0;
    return part;
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

RollPitchYaw rotation_rms(const Recording& r) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    std::vector<Quat> attitudes = r.attitude;
    if (attitudes.empty() && !r.rate.empty()) {
        const Vec3 bias = mean_of(r.rate, r.rate.size());
        attitudes.push_back(r.info.attitude());
        for (std::size_t k = 1; k < r.size(); ++k) {
            const Vec3 mean = 0.5 * (r.rate[k] + r.rate[k - 1]) - bias;
            attitudes.push_back(attitudes.back() *
                                exponential_map((r.time[k] - r.time[k - 1]) * mean));
        }
    }
    if (attitudes.size() < 3) return {nan, nan, nan};
    // small rotations from the first attitude, so that a tilted rock has no pole nearby
    std::vector<Quat> turns;
    for (const Quat& q : attitudes) turns.push_back(q * attitudes.front().conjugate());
    const auto angles = unwrapped_roll_pitch_yaw(turns);
    const auto rms = [&](double RollPitchYaw::*angle) {
        std::vector<double> series;
        for (const RollPitchYaw& a : angles) series.push_back(a.*angle);
        detrend(series, Detrend::line);
        const double squares =
            std::inner_product(series.begin(), series.end(), series.begin(), 0.0);
        return std::sqrt(squares / static_cast<double>(series.size()));
    };
    return {rms(&RollPitchYaw::roll), rms(&RollPitchYaw::pitch), rms(&RollPitchYaw::yaw)};
}

} // namespace bris

#include "scenarios/monitoring/bursts.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double window = 0.25, context = 4; ///< s
constexpr double least_ratio = 4;            ///< to the quiet level
constexpr double shortest = 0.5;             ///< s, sum of the active windows of a train
constexpr std::size_t most_windows = 50'000'000;

/// Sums over the samples of one window.
struct Window {
    Vec3 sum = Vec3::Zero();
    double squares = 0, samples = 0;
};

/// Length of the windows, s; slow sensors have four samples in each.
double length_for(const Recording& r) { return std::max(window, 4 / r.info.sampling_rate); }

std::vector<Window> windows_of(const Recording& r, double length) {
    const auto& values = r.force.empty() ? r.rate : r.force;
    const double count = (r.time.back() - r.time.front()) / length + 1;
    if (values.empty() || !(count < static_cast<double>(most_windows))) return {};
    const Vec3 first = values.front(); // sums of small numbers are exact enough
    std::vector<Window> windows(static_cast<std::size_t>(count));
    for (std::size_t k = 0; k < r.size(); ++k) {
        const auto w = static_cast<std::size_t>((r.time[k] - r.time.front()) / length);
        Window& of = windows[std::min(w, windows.size() - 1)];
        const Vec3 v = values[k] - first;
        of.sum += v;
        of.squares += v.squaredNorm();
        of.samples += 1;
    }
    return windows;
}

/// Root mean square of each window about the mean of its neighbourhood; -1: without samples.
std::vector<double> levels_of(const std::vector<Window>& windows, double length) {
    const auto half = static_cast<std::size_t>(std::round(0.5 * context / length));
    std::vector<Window> total(windows.size() + 1); // of all before
    for (std::size_t w = 0; w < windows.size(); ++w) {
        total[w + 1].sum = total[w].sum + windows[w].sum;
        total[w + 1].samples = total[w].samples + windows[w].samples;
    }
    std::vector<double> levels;
    for (std::size_t w = 0; w < windows.size(); ++w) {
        const std::size_t from = w - std::min(w, half), to = std::min(w + half + 1, windows.size());
        const Window& here = windows[w];
        if (here.samples == 0) {
            levels.push_back(-1);
            continue;
        }
        const Vec3 mean =
            (total[to].sum - total[from].sum) / (total[to].samples - total[from].samples);
        const double squares = here.squares / here.samples - 2 * mean.dot(here.sum) / here.samples +
                               mean.squaredNorm();
        levels.push_back(std::sqrt(std::max(0.0, squares)));
    }
    return levels;
}

/// Level from which a window is active; infinite: none is.
double threshold_for(std::vector<double> levels) {
    std::erase_if(levels, [](double x) { return !(x > 0); }); // of a clock that stood still, too
    if (levels.empty()) return HUGE_VAL;
    const auto quarter = levels.begin() + static_cast<std::ptrdiff_t>(levels.size() / 4);
    std::nth_element(levels.begin(), quarter, levels.end());
    return least_ratio * *quarter;
}

} // namespace

Bursts bursts_in(const std::vector<Recording>& recordings, double quiet) {
    std::vector<Burst> active;
    for (const Recording& r : recordings) {
        if (r.size() < 2) continue;
        const double length = length_for(r);
        const auto levels = levels_of(windows_of(r, length), length);
        const double threshold = threshold_for(levels);
        for (std::size_t w = 0; w < levels.size(); ++w)
            if (levels[w] > threshold) {
                const double begin = r.time.front() + static_cast<double>(w) * length;
                active.push_back({begin, begin + length});
            }
    }
    std::ranges::sort(active, {}, &Burst::begin);
    Bursts bursts;
    double duration = 0, until = 0; // of the windows of a burst, each moment once
    const auto finish = [&] {
        if (bursts.all.empty() || duration >= shortest) return;
        bursts.all.pop_back();
        ++bursts.too_short;
    };
    for (const Burst& b : active) {
        if (bursts.all.empty() || b.begin - bursts.all.back().end >= quiet) {
            finish();
            bursts.all.push_back(b);
            duration = 0, until = b.begin;
        }
        duration += std::max(0.0, b.end - std::max(until, b.begin));
        until = std::max(until, b.end);
        bursts.all.back().end = until;
    }
    finish();
    return bursts;
}

} // namespace bris

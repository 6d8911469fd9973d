#include "scenarios/monitoring/activity.hpp"

#include <cmath>

namespace bris {

namespace {

constexpr double half_window = 0.125; // s

/// Slides a window over rows: `last - first` rows lie within `half` of the time of row k.
struct Window {
    std::size_t first = 0, last = 0;
    void move(const Samples& s, std::size_t k, double half) {
        while (s.time(first) < s.time(k) - half) ++first;
        while (last < s.size() && s.time(last) <= s.time(k) + half) ++last;
    }
};

Vec3 vector_at(const Samples& s, std::size_t k, const SensorInfo& info, bool by_force) {
    const Vec3 v = by_force ? s.force_at(k, info) : Vec3(info.attitude() * s.rate_at(k, info));
    return v.allFinite() ? v : Vec3::Zero();
}

/// The quantity less its mean nearby, at each row; 0 before `from`.
std::vector<double> deviations_of(const Samples& s, const SensorInfo& info,
                                  VibrationQuantity quantity, std::size_t from) {
    const bool by_force = quantity == VibrationQuantity::vertical;
    std::vector<Vec3> vectors(from, Vec3::Zero()), sums(from + 1, Vec3::Zero());
    for (std::size_t k = from; k < s.size(); ++k) {
        vectors.push_back(vector_at(s, k, info, by_force));
        sums.push_back(sums.back() + vectors.back());
    }
    const Eigen::Index axis = axis_of(quantity);
    std::vector<double> deviations(from, 0);
    Window nearby{from, from};
    for (std::size_t k = from; k < s.size(); ++k) {
        nearby.move(s, k, activity_context);
        const Vec3 mean = (sums[nearby.last] - sums[nearby.first]) /
                          static_cast<double>(nearby.last - nearby.first);
        deviations.push_back(by_force ? (vectors[k] - mean).dot(mean.normalized())
                                      : (vectors[k] - mean)[axis]);
    }
    return deviations;
}

} // namespace

void find_activity(Samples& samples, const SensorInfo& info, const ActivitySettings& settings,
                   double until) {
    const std::size_t end = samples.row_at(std::nextafter(until, 1e300));
    std::size_t first = 0;
    while (first < end && samples.state(first) != Samples::State::unknown) ++first;
    if (first == end) return;
    const bool by_force = settings.quantity == VibrationQuantity::vertical;
    if (!(settings.threshold > 0) || !(by_force ? samples.has_force() : samples.has_rate())) {
        for (; first < end; ++first) samples.state(first) = Samples::State::quiet;
        return;
    }
    // the windows of the first row to be said, and what lies near to them
    const std::size_t nearby = samples.row_at(samples.time(first) - half_window),
                      from = samples.row_at(samples.time(nearby) - activity_context);
    const std::vector<double> d = deviations_of(samples, info, settings.quantity, from);
    std::vector<double> squares{0};
    for (const double x : d) squares.push_back(squares.back() + x * x);
    Window window{nearby, nearby};
    for (std::size_t k = first; k < end; ++k) {
        window.move(samples, k, half_window);
        if (samples.state(k) != Samples::State::unknown) continue;
        const double mean = (squares[window.last] - squares[window.first]) /
                            static_cast<double>(window.last - window.first);
        samples.state(k) = mean > settings.threshold * settings.threshold ? Samples::State::active
                                                                          : Samples::State::quiet;
    }
}

std::vector<PassageInterval> passages_in(const Samples& samples, const ActivitySettings& settings) {
    std::vector<PassageInterval> found;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        if (samples.state(k) != Samples::State::active) continue;
        const double t = samples.time(k);
        if (found.empty() || t - found.back().end >= settings.quiet ||
            t - found.back().begin > settings.longest)
            found.push_back({t, t});
        else
            found.back().end = t;
    }
    return found;
}

} // namespace bris

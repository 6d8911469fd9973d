#include "scenarios/sensors/inspection.hpp"

#include "engine/signal/median.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace bris {

namespace {

constexpr std::size_t fewest = 4; // samples at rest, and triples of samples in the test

/// Standard deviation of the values at rest, estimated by the median of deviations from the median.
double deviation_at_rest(const std::vector<Vec3>& values, std::size_t still) {
    const Vec3 middle = median(
        std::vector<Vec3>(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(still)));
    std::vector<double> deviation;
    for (std::size_t k = 0; k < still; ++k)
        for (const double d : (values[k] - middle).eval()) deviation.push_back(std::abs(d));
    return deviation_of_median(median(std::move(deviation)));
}

/// Standard deviation of the noise on a steady motion, estimated from second differences.
double deviation_of_motion(const std::vector<Vec3>& values, std::size_t first) {
    std::vector<double> bends;
    for (std::size_t k = first + 1; k + 1 < values.size(); ++k)
        for (const double b : (values[k + 1] - 2 * values[k] + values[k - 1]).eval())
            bends.push_back(std::abs(b));
    return deviation_of_median(median(std::move(bends))) / std::sqrt(6.0); // norm of (1, -2, 1)
}

/// The longest number of successive samples in which a component does not change.
std::size_t longest_run(const std::vector<Vec3>& values, Eigen::Index axis) {
    std::size_t run = 0, longest = 0;
    for (std::size_t k = 1; k < values.size(); ++k)
        longest = std::max(longest,
                           run = values[k][axis] == values[k - 1][axis] ? run + 1 : std::size_t{0});
    return longest;
}

/// Whether the changes of a component are fine: the median is many times the smallest.
bool changes_finely(const std::vector<Vec3>& values, Eigen::Index axis) {
    constexpr double fine = 4;
    std::vector<double> changes;
    for (std::size_t k = 1; k < values.size(); ++k)
        if (values[k][axis] != values[k - 1][axis])
            changes.push_back(std::abs(values[k][axis] - values[k - 1][axis]));
    if (changes.size() < 2 * fewest) return false;
    const double smallest = std::ranges::min(changes);
    return median(std::move(changes)) > fine * smallest;
}

} // namespace

bool has_stuck_axis(const Inspection& at, const char* what, const std::vector<Vec3>& values) {
    constexpr std::size_t least_run = 10, times_others = 5;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const Eigen::Index next = (axis + 1) % 3, after = (axis + 2) % 3;
        const std::size_t run = longest_run(values, axis),
                          others = std::max(longest_run(values, next), longest_run(values, after));
        const double stuck = static_cast<double>(run) / at.recording.info.sampling_rate;
        if (run < least_run || run < times_others * others || stuck <= at.limits.stuck ||
            !changes_finely(values, next) || !changes_finely(values, after))
            continue;
        at.refuse("stuck", fmt::format("{}: component {}: expected noise, as in the others, found "
                                       "the same value for {:.3g} s",
                                       what, "xyz"[axis], stuck));
        return true;
    }
    return false;
}

void check_scatter(const Inspection& at, const char* what, const std::vector<Vec3>& values,
                   double declared, double roughness, const char* unit, double scale) {
    const auto compare = [&](const char* when, double found, double rough) {
        const auto text = fmt::format("{} {}: declared {:.3g} {}, found {:.3g}", what, when,
                                      declared / scale, unit, found / scale);
        if (found > at.limits.noise_refused * declared + rough)
            at.refuse("noise", text);
        else if (found > at.limits.noise_ratio * declared + rough)
            at.note("noise", text);
    };
    if (at.still >= fewest) compare("at rest", deviation_at_rest(values, at.still), 0);
    if (!at.recording.strain.empty() && values.size() >= at.still + fewest + 2)
        compare("from sample to sample", deviation_of_motion(values, at.still), roughness);
}

double strain_step(const Inspection& at) {
    std::vector<double> steps;
    const auto& strain = at.recording.strain;
    std::optional<std::size_t> before; // strain may be sampled less often than other channels
    for (std::size_t k = std::max<std::size_t>(at.still, 1) - 1; k < strain.size(); ++k) {
        if (!std::isfinite(strain[k])) continue;
        if (before)
            steps.push_back(std::abs(strain[k] - strain[*before]) /
                            static_cast<double>(k - *before));
        before = k;
    }
    return steps.empty() ? 0 : median(std::move(steps));
}

} // namespace bris

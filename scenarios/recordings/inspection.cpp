#include "scenarios/recordings/inspection.hpp"

#include "engine/signal/median.hpp"

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

} // namespace

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

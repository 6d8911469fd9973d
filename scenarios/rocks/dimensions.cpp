#include "scenarios/rocks/dimensions.hpp"

#include "engine/random.hpp"
#include "scenarios/rocks/lattice_direction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace bris {

namespace {

Vec3 least_width_direction(std::span<const Ball> balls) {
    constexpr std::size_t lattice = 4000, kept = 12;
    std::vector<std::pair<double, std::size_t>> ranked;
    for (std::size_t k = 0; k < lattice / 2; ++k) // opposite directions have equal widths
        ranked.emplace_back(width(balls, lattice_direction(k, lattice)), k);
    for (std::size_t axis = 0; axis < 3; ++axis)
        ranked.emplace_back(width(balls, Vec3::Unit(static_cast<Eigen::Index>(axis))),
                            lattice + axis);
    std::partial_sort(ranked.begin(), ranked.begin() + kept, ranked.end());
    Random random(2, 0);
    double least = std::numeric_limits<double>::infinity();
    Vec3 result = Vec3::UnitX();
    for (std::size_t k = 0; k < kept; ++k) {
        auto [best, index] = ranked[k];
        Vec3 direction = index < lattice ? lattice_direction(index, lattice)
                                         : Vec3::Unit(static_cast<Eigen::Index>(index - lattice));
        for (double step = 0.05; step > 1e-6; step *= 0.6)
            for (int trial = 0; trial < 16; ++trial) {
                const Vec3 moved = (direction + step * random.direction()).normalized();
                const double found = width(balls, moved);
                if (found < best) best = found, direction = moved;
            }
        if (best < least) least = best, result = direction;
    }
    return result;
}

/// Direction of the least width among those perpendicular to `axis`: 720 angles, refined by
/// halving the step.
Vec3 least_width_across(std::span<const Ball> balls, const Vec3& axis) {
    const Vec3 u = axis.unitOrthogonal(), v = axis.cross(u);
    const auto at = [&](double angle) { return Vec3(std::cos(angle) * u + std::sin(angle) * v); };
    constexpr int angles = 720;
    double best = 0, least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < angles; ++k)
        if (const double found = width(balls, at(pi * k / angles)); found < least)
            least = found, best = pi * k / angles;
    for (double step = pi / angles; step > 1e-8; step *= 0.5)
        for (double side : {-step, step})
            if (const double found = width(balls, at(best + side)); found < least)
                least = found, best += side;
    return at(best);
}

} // namespace

double width(std::span<const Ball> balls, const Vec3& direction) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Ball& ball : balls) {
        const double along = ball.centre.dot(direction);
        low = std::min(low, along - ball.radius);
        high = std::max(high, along + ball.radius);
    }
    return high - low;
}

Dimensions compute_dimensions(std::span<const Ball> balls) {
    const Vec3 shortest = least_width_direction(balls);
    const Vec3 intermediate = least_width_across(balls, shortest);
    const Vec3 longest = intermediate.cross(shortest);
    Dimensions result{
        width(balls, longest), width(balls, intermediate), width(balls, shortest), {}};
    result.axes << longest, intermediate, shortest;
    return result;
}

} // namespace bris

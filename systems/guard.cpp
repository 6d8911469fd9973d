#include "systems/guard.hpp"

#include "engine/lane_math.hpp"

#include <fmt/format.h>

#include <limits>

namespace bris {

namespace {

std::string point(const Vec3& x) { return fmt::format("({:g}, {:g}, {:g})", x.x(), x.y(), x.z()); }

LaneMask at_least(const Vec3Lanes& a, const Vec3& low) { return (a.x >= low.x()) & (a.y >= low.y()) & (a.z >= low.z()); }

bool all_well(WatchedBodies bodies, const Limits& limits) {
    const double* travel = bodies.column<Travel>();
    const Vec3* velocity = bodies.column<Velocity>();
    const Vec3* position = bodies.column<Position>();
    const auto* motion = bodies.column<MotionOf>();
    const double limit = limits.speed * limits.speed;
    const Vec3Lanes none{};
    bool well = true;
    for_lane_rows(bodies.first(), bodies.last(), [&](LaneRows rows) {
        const Vec3Lanes x = load(position, rows), v = load(velocity, rows);
        const LaneMask driven = ~equal(motion, rows, static_cast<std::uint32_t>(Motion::free));
        const LaneMask inside = at_least(x, limits.low) & at_least(none - x, -limits.high);
        const unsigned all = (1u << rows.count) - 1, here = bits((load(travel, rows) < std::numeric_limits<double>::infinity()) &
                                                                  (dot(v, v) <= limit) & (driven | inside));
        well = well && (here & all) == all;
    });
    return well;
}

} // namespace

void guard_motion(WatchedBodies bodies, const Limits& limits, Health& health) {
    if (all_well(bodies, limits)) return;
    const double* travel = bodies.column<Travel>();
    const Vec3* velocity = bodies.column<Velocity>();
    const Vec3* position = bodies.column<Position>();
    const auto* motion = bodies.column<MotionOf>();
    const double limit = limits.speed * limits.speed;
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        const Vec3& x = position[b];
        const bool finite = travel[b] < std::numeric_limits<double>::infinity();
        const bool slow = velocity[b].squaredNorm() <= limit;
        const bool inside = motion[b] != static_cast<std::uint32_t>(Motion::free) ||
                            ((x.array() >= limits.low.array()).all() && (x.array() <= limits.high.array()).all());
        if (finite && slow && inside) continue;
        health.bad = true;
        health.what = fmt::format("body {} at {} m: expected ", bodies.column<BodyId>()[b], point(x));
        if (finite && slow)
            health.what += fmt::format("a place between {} and {} m: it has escaped", point(limits.low), point(limits.high));
        else
            health.what += fmt::format("a speed up to {:g} m/s, found {:g} m/s; try a smaller step", limits.speed,
                                       velocity[b].norm());
        return;
    }
}

} // namespace bris

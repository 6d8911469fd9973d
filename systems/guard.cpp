#include "systems/guard.hpp"

#include "engine/lane_math.hpp"

#include <fmt/format.h>

#include <limits>

namespace bris {

namespace {

std::string point(const Vec3& x) { return fmt::format("({:g}, {:g}, {:g})", x.x(), x.y(), x.z()); }

LaneMask at_least(const Vec3Lanes& a, const Vec3& low) { return (a.x >= low.x()) & (a.y >= low.y()) & (a.z >= low.z()); }

/// The first body that is no number, too fast or outside; no_row if all is well.
Row first_astray(WatchedBodies bodies, const Limits& limits) {
    const double* travel = bodies.column<Travel>();
    const Vec3* velocity = bodies.column<Velocity>();
    const Vec3* position = bodies.column<Position>();
    const auto* motion = bodies.column<MotionOf>();
    const double limit = limits.speed * limits.speed;
    Row first = no_row;
    for_lane_rows(bodies.first(), bodies.last(), [&](LaneRows rows) {
        const Vec3Lanes x = load(position, rows), v = load(velocity, rows);
        const LaneMask driven = ~equal(motion, rows, static_cast<std::uint32_t>(Motion::free));
        const LaneMask inside = at_least(x, limits.low) & at_least(Vec3Lanes{} - x, -limits.high);
        const LaneMask finite = load(travel, rows) < std::numeric_limits<double>::infinity(), slow = dot(v, v) <= limit;
        const unsigned astray = ~bits(finite & slow & (driven | inside)) & ((1u << rows.count) - 1);
        if (astray != 0 && first == no_row) first = rows.first + static_cast<Row>(__builtin_ctz(astray));
    });
    return first;
}

} // namespace

void guard_motion(WatchedBodies bodies, const Limits& limits, Health& health) {
    const Row b = first_astray(bodies, limits);
    if (b == no_row) return;
    const double speed = bodies.column<Velocity>()[b].norm();
    const bool escaped = bodies.column<Travel>()[b] < std::numeric_limits<double>::infinity() && speed <= limits.speed;
    health.bad = true;
    health.what = fmt::format("body {} at {} m: expected ", bodies.column<BodyId>()[b], point(bodies.column<Position>()[b]));
    if (escaped)
        health.what += fmt::format("a place between {} and {} m: it has escaped", point(limits.low), point(limits.high));
    else
        health.what += fmt::format("a speed up to {:g} m/s, found {:g} m/s; try a smaller step", limits.speed, speed);
}

} // namespace bris

#include "systems/guard.hpp"

#include "engine/lane_math.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

std::string point(const Vec3& x) { return fmt::format("({:g}, {:g}, {:g})", x.x(), x.y(), x.z()); }

LaneMask at_least(const Vec3Lanes& a, const Vec3& low) {
    return (a.x >= low.x()) & (a.y >= low.y()) & (a.z >= low.z());
}

/// A step must not carry a surface past another: this much at most, of a radius.
double longest_way(const Limits& limits, double radius) { return limits.overlap * radius; }

struct Astray {
    Row body = no_row; ///< no number, too fast, outside, or too far in one step
    double smallest_free = std::numeric_limits<double>::infinity(); ///< m, bounding radius
    double fastest_driven = 0;                                      ///< m/s
};

/// The first body with whom something is wrong, and what tells whether a boundary moves too far.
Astray look_at(WatchedBodies bodies, const Limits& limits, double dt) {
    const double* travel = bodies.column<Travel>();
    const double* radius = bodies.column<BoundingRadius>();
    const Vec3* velocity = bodies.column<Velocity>();
    const Vec3* position = bodies.column<Position>();
    const Vec3* spin = bodies.column<Spin>();
    const auto* motion = bodies.column<MotionOf>();
    const double infinite = std::numeric_limits<double>::infinity(),
                 limit = limits.speed * limits.speed;
    Astray astray;
    Lane smallest = lanes(infinite), fastest{};
    for_lane_rows(bodies.first(), bodies.last(), [&](LaneRows rows) {
        const Vec3Lanes x = load(position, rows), v = load(velocity, rows), w = load(spin, rows);
        const LaneMask free = equal(motion, rows, static_cast<std::uint32_t>(Motion::free));
        const LaneMask inside = at_least(x, limits.low) & at_least(Vec3Lanes{} - x, -limits.high);
        const Lane r = load(radius, rows), squared = dot(v, v), way = limits.overlap * r;
        const LaneMask finite = (load(travel, rows) < infinite) & (dot(w, w) < infinite),
                       slow = squared <= limit, near = (dt * dt) * squared <= way * way;
        const unsigned wrong =
            ~bits(finite & slow & (~free | (inside & near))) & ((1u << rows.count) - 1);
        if (wrong != 0 && astray.body == no_row)
            astray.body = rows.first + static_cast<Row>(__builtin_ctz(wrong));
        smallest = min(smallest, free & (r > 0.0) ? r : lanes(infinite)); // empty lanes have none
        fastest = max(fastest, free ? Lane{} : squared);
    });
    for (std::size_t k = 0; k < lane_count; ++k) {
        astray.smallest_free = std::min(astray.smallest_free, smallest[k]);
        astray.fastest_driven = std::max(astray.fastest_driven, std::sqrt(fastest[k]));
    }
    return astray;
}

/// The first driven body that moves further in a step than its smallest grain allows.
Row first_hasty(WatchedBodies bodies, double way, double dt) {
    for (Row b = bodies.first(); b < bodies.last(); ++b)
        if (bodies.column<MotionOf>()[b] != static_cast<std::uint32_t>(Motion::free) &&
            bodies.column<Velocity>()[b].norm() * dt > way)
            return b;
    return no_row;
}

} // namespace

void guard_motion(WatchedBodies bodies, const Limits& limits, const Clock& clock, Health& health) {
    const Astray astray = look_at(bodies, limits, clock.dt);
    double way = longest_way(limits, astray.smallest_free);
    Row b = astray.body;
    if (b == no_row && astray.fastest_driven * clock.dt > way)
        b = first_hasty(bodies, way, clock.dt);
    if (b == no_row) return;
    if (bodies.column<MotionOf>()[b] == static_cast<std::uint32_t>(Motion::free))
        way = longest_way(limits, bodies.column<BoundingRadius>()[b]);
    const Vec3& x = bodies.column<Position>()[b];
    const double speed = bodies.column<Velocity>()[b].norm();
    health.bad = true;
    health.what = fmt::format("body {} at {} m: expected ", bodies.column<BodyId>()[b], point(x));
    const double spin = bodies.column<Spin>()[b].norm();
    if (!std::isfinite(spin))
        health.what += fmt::format("a finite spin, found {:g} rad/s; try a smaller step", spin);
    else if (!(bodies.column<Travel>()[b] < std::numeric_limits<double>::infinity() &&
               speed <= limits.speed))
        health.what += fmt::format("a speed up to {:g} m/s, found {:g} m/s; try a smaller step",
                                   limits.speed, speed);
    else if (speed * clock.dt > way)
        health.what +=
            fmt::format("a way up to {:g} m in a step, found {:g} m ({:g} m/s); try a smaller step",
                        way, speed * clock.dt, speed);
    else
        health.what += fmt::format("a place between {} and {} m: it has escaped", point(limits.low),
                                   point(limits.high));
}

} // namespace bris

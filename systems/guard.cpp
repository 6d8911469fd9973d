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

/// Largest displacement (m) in a step that cannot carry a surface past another of this radius.
double largest_displacement(const Limits& limits, double radius) { return limits.overlap * radius; }

struct Offender {
    /// Its state is not finite, it is too fast or outside the box, or it moves too far in one step.
    Row body = no_row;
    double smallest_free = std::numeric_limits<double>::infinity(); ///< m, bounding radius
    double fastest_driven = 0;                                      ///< m/s
};

/// The first body that violates a limit, and the numbers that decide whether a boundary moves too
/// far.
Offender find_offender(WatchedBodies bodies, const Limits& limits, double dt) {
    const double* displacement = bodies.column<DisplacementBound>();
    const double* radius = bodies.column<BoundingRadius>();
    const Vec3* velocity = bodies.column<Velocity>();
    const Vec3* position = bodies.column<Position>();
    const Vec3* omega = bodies.column<AngularVelocity>();
    const auto* motion = bodies.column<MotionOf>();
    const double infinite = std::numeric_limits<double>::infinity(),
                 limit = limits.speed * limits.speed;
    Offender offender;
    Lane smallest = lanes(infinite), fastest{};
    for_lane_rows(bodies.first(), bodies.last(), [&](LaneRows rows) {
        const Vec3Lanes x = load(position, rows), v = load(velocity, rows), w = load(omega, rows);
        const LaneMask free = equal(motion, rows, static_cast<std::uint32_t>(Motion::free));
        const LaneMask inside = at_least(x, limits.low) & at_least(Vec3Lanes{} - x, -limits.high);
        const Lane r = load(radius, rows), squared = dot(v, v), limit_of_step = limits.overlap * r;
        const LaneMask finite = (load(displacement, rows) < infinite) & (dot(w, w) < infinite),
                       slow = squared <= limit,
                       near = (dt * dt) * squared <= limit_of_step * limit_of_step;
        const unsigned wrong =
            ~bits(finite & slow & (~free | (inside & near))) & ((1u << rows.count) - 1);
        if (wrong != 0 && offender.body == no_row)
            offender.body = rows.first + static_cast<Row>(__builtin_ctz(wrong));
        smallest =
            min(smallest, free & (r > 0.0) ? r : lanes(infinite)); // empty lanes have radius 0
        fastest = max(fastest, free ? Lane{} : squared);
    });
    for (std::size_t k = 0; k < lane_count; ++k) {
        offender.smallest_free = std::min(offender.smallest_free, smallest[k]);
        offender.fastest_driven = std::max(offender.fastest_driven, std::sqrt(fastest[k]));
    }
    return offender;
}

/// The first driven body that moves further in a step than the smallest grain allows.
Row first_too_fast(WatchedBodies bodies, double limit_of_step, double dt) {
    for (Row b = bodies.first(); b < bodies.last(); ++b)
        if (bodies.column<MotionOf>()[b] != static_cast<std::uint32_t>(Motion::free) &&
            bodies.column<Velocity>()[b].norm() * dt > limit_of_step)
            return b;
    return no_row;
}

} // namespace

std::string contact_message(const PairNames& who, const ForceRow& contact, double radius,
                            double limit, double largest_force) {
    if (contact.overlap > limit * radius)
        return fmt::format("overlap of bodies {} and {}: expected less than {:g} of the mean radius "
                           "({:.4g} m), found {:.4g} of it ({:.4g} m)",
                           who.owner, who.partner, limit, limit * radius, contact.overlap / radius,
                           contact.overlap);
    return fmt::format("contact force of bodies {} and {}: expected a number up to {:.4g} N, found "
                       "{:.4g} N at an overlap of {:.4g} m",
                       who.owner, who.partner, largest_force,
                       Vec3(contact.fx, contact.fy, contact.fz).norm(), contact.overlap);
}

void guard_motion(WatchedBodies bodies, const Limits& limits, const Clock& clock, Health& health) {
    if (health.bad) return; // a contact beyond its limits is the cause
    const Offender offender = find_offender(bodies, limits, clock.dt);
    double limit_of_step = largest_displacement(limits, offender.smallest_free);
    Row b = offender.body;
    if (b == no_row && offender.fastest_driven * clock.dt > limit_of_step)
        b = first_too_fast(bodies, limit_of_step, clock.dt);
    if (b == no_row) return;
    if (bodies.column<MotionOf>()[b] == static_cast<std::uint32_t>(Motion::free))
        limit_of_step = largest_displacement(limits, bodies.column<BoundingRadius>()[b]);
    const Vec3& x = bodies.column<Position>()[b];
    const double speed = bodies.column<Velocity>()[b].norm();
    health.bad = true;
    health.what = fmt::format("body {} at {} m: expected ", bodies.column<BodyId>()[b], point(x));
    const double omega = bodies.column<AngularVelocity>()[b].norm();
    if (!std::isfinite(omega))
        health.what += fmt::format("a finite angular velocity, found {:g} rad/s", omega);
    else if (!(bodies.column<DisplacementBound>()[b] < std::numeric_limits<double>::infinity() &&
               speed <= limits.speed))
        health.what += fmt::format("a speed up to {:g} m/s, found {:g} m/s", limits.speed, speed);
    else if (speed * clock.dt > limit_of_step)
        health.what += fmt::format("a displacement up to {:g} m in a step, found {:g} m ({:g} m/s)",
                                   limit_of_step, speed * clock.dt, speed);
    else
        health.what += fmt::format("a position between {} and {} m: it has escaped",
                                   point(limits.low), point(limits.high));
}

} // namespace bris

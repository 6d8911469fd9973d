#include "systems/guard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

std::string point(const Vec3& x) { return fmt::format("({:g}, {:g}, {:g})", x.x(), x.y(), x.z()); }

/// The first of the bodies that violates a limit, or no_row.
Row find_offender(const WatchedBodies& bodies, Row first, Row last, const Limits& limits,
                  const Clock& clock, const Census& census) {
    const double* displacement = bodies.column<DisplacementBound>();
    const double* radius = bodies.column<BoundingRadius>();
    const Vec3* velocity = bodies.column<Velocity>();
    const Vec3* position = bodies.column<Position>();
    const Vec3* omega = bodies.column<AngularVelocity>();
    const auto* motion = bodies.column<MotionOf>();
    const MotionLimits within(limits, clock, census);
    Row offender = no_row;
    for_lane_rows(first, last, [&](LaneRows rows) {
        const LaneMask free = equal(motion, rows, static_cast<std::uint32_t>(Motion::free));
        const LaneMask allowed =
            within.allow(load(position, rows), load(velocity, rows), load(omega, rows),
                         load(displacement, rows), load(radius, rows), free);
        const unsigned wrong = ~bits(allowed) & ((1u << rows.count) - 1);
        if (wrong != 0 && offender == no_row)
            offender = rows.first + static_cast<Row>(__builtin_ctz(wrong));
    });
    return offender;
}

} // namespace

std::string contact_message(const PairNames& who, const ForceRow& contact, double radius,
                            double limit, double largest_force) {
    if (contact.overlap > limit * radius)
        return fmt::format(
            "overlap of bodies {} and {}: expected less than {:g} of the mean radius "
            "({:.4g} m), found {:.4g} of it ({:.4g} m)",
            who.owner, who.partner, limit, limit * radius, contact.overlap / radius,
            contact.overlap);
    return fmt::format("contact force of bodies {} and {}: expected a number up to {:.4g} N, found "
                       "{:.4g} N at an overlap of {:.4g} m",
                       who.owner, who.partner, largest_force,
                       Vec3(contact.fx, contact.fy, contact.fz).norm(), contact.overlap);
}

void watch_motion(WatchedBodies bodies, const Limits& limits, const Clock& clock,
                  const Census& census, Alarm& alarm) {
    if (find_offender(bodies, bodies.first(), bodies.last(), limits, clock, census) != no_row)
        alarm.raise();
}

void guard_motion(WatchedBodies bodies, const Limits& limits, const Clock& clock,
                  const Census& census, Alarm& alarm, Health& health) {
    Row b = no_row;
    if (alarm.raised)
        b = find_offender(bodies, 0, static_cast<Row>(bodies.size()), limits, clock, census);
    for (const Row boundary : census.boundaries)
        if (b == no_row) b = find_offender(bodies, boundary, boundary + 1, limits, clock, census);
    alarm.raised = false;
    if (b == no_row || health.bad) return; // a contact beyond its limits is the cause
    const bool free = bodies.column<MotionOf>()[b] == static_cast<std::uint32_t>(Motion::free);
    const double most =
        limits.overlap * (free ? bodies.column<BoundingRadius>()[b] : census.smallest_free_radius);
    const Vec3& x = bodies.column<Position>()[b];
    const double speed = bodies.column<Velocity>()[b].norm(),
                 omega = bodies.column<AngularVelocity>()[b].norm();
    health.bad = true;
    health.what = fmt::format("body {} at {} m: expected ", bodies.column<BodyId>()[b], point(x));
    if (!std::isfinite(omega))
        health.what += fmt::format("a finite angular velocity, found {:g} rad/s", omega);
    else if (!(bodies.column<DisplacementBound>()[b] < std::numeric_limits<double>::infinity() &&
               speed <= limits.speed))
        health.what += fmt::format("a speed up to {:g} m/s, found {:g} m/s", limits.speed, speed);
    else if (speed * clock.dt > most)
        health.what += fmt::format("a displacement up to {:g} m in a step, found {:g} m ({:g} m/s)",
                                   most, speed * clock.dt, speed);
    else
        health.what += fmt::format("a position between {} and {} m: it has escaped",
                                   point(limits.low), point(limits.high));
}

} // namespace bris

#include "systems/guard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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

std::string message_of(const Overload& body, const ForceGrid& grid) {
    const std::string expected =
        fmt::format("contact forces on body {}: expected magnitudes that add to at most {:.4g} N",
                    body.body, grid.limit_of_sum());
    if (body.is_boundary)
        return expected + fmt::format(" on a part of it, found {:.4g} N; it has {} contacts",
                                      body.size, body.contacts);
    // magnitudes of the components of a force alone add to up to 1.7 times the force
    const double mean = body.size / static_cast<double>(std::max<std::uint64_t>(body.contacts, 1));
    const char* cause = mean <= 2 * grid.at_limit ? "there are too many"
                        : grid.dashpot > 0        ? "their dashpots are too strong for such speeds"
                                                  : "their springs are too stiff";
    return expected + fmt::format(", found {:.4g} N in {} contacts, {:.4g} N in the mean, where "
                                  "springs at the limit of overlap exert {:.4g} N: {}",
                                  body.size, body.contacts, mean, grid.at_limit, cause);
}

/// What is wrong with the motion of a body.
std::string what_moves_wrongly(const WatchedBodies& bodies, Row b, const Limits& limits,
                               const Clock& clock, const Census& census) {
    const Vec3& x = bodies.column<Position>()[b];
    const double speed = bodies.column<Velocity>()[b].norm(),
                 omega = bodies.column<AngularVelocity>()[b].norm();
    const bool free = bodies.column<MotionOf>()[b] == static_cast<std::uint32_t>(Motion::free);
    const double most =
        limits.overlap * (free ? bodies.column<BoundingRadius>()[b] : census.smallest_free_radius);
    if (!std::isfinite(omega))
        return fmt::format("expected a finite angular velocity, found {:g} rad/s", omega);
    if (!std::isfinite(speed)) return fmt::format("expected a finite speed, found {:g} m/s", speed);
    if (!x.allFinite()) return "expected a finite position, found none";
    const std::string at = "at " + point(x) + " m: expected ";
    if (!(bodies.column<DisplacementBound>()[b] < std::numeric_limits<double>::infinity() &&
          speed <= limits.speed))
        return at + fmt::format("a speed up to {:g} m/s, found {:g} m/s", limits.speed, speed);
    if (speed * clock.dt > most)
        return at + fmt::format("a displacement up to {:g} m in a step, found {:g} m ({:g} m/s)",
                                most, speed * clock.dt, speed);
    return at + fmt::format("a position between {} and {} m: it has escaped", point(limits.low),
                            point(limits.high));
}

} // namespace

std::string contact_message(const PairNames& who, const ForceRow& contact, double radius,
                            double limit, double arm, const ForceGrid& grid) {
    if (contact.overlap > limit * radius)
        return fmt::format(
            "overlap of bodies {} and {}: expected less than {:g} of the mean radius "
            "({:.4g} m), found {:.4g} of it ({:.4g} m)",
            who.owner, who.partner, limit, limit * radius, contact.overlap / radius,
            contact.overlap);
    const double force = Vec3(contact.fx, contact.fy, contact.fz).norm();
    const std::string bodies =
        fmt::format("contact of bodies {} and {}: expected ", who.owner, who.partner);
    if (!std::isfinite(force))
        return bodies + fmt::format("a finite force, found {:g} N at an overlap of {:.4g} m", force,
                                    contact.overlap);
    const char* cause = force <= grid.at_limit ? "its lever arms are too long"
                        : grid.dashpot > 0     ? "its dashpot is too strong for such speeds"
                                               : "its springs are too stiff";
    const std::string at =
        arm > 0 ? fmt::format(" {:.4g} m from the centre of body {}", arm, who.partner) : "";
    return bodies + fmt::format("force and torques that add to at most {:.4g} N in magnitude, "
                                "found {:.4g} N at an overlap of {:.4g} m{}: {}",
                                grid.largest_size(), force, contact.overlap, at, cause);
}

void watch_motion(WatchedBodies bodies, const Limits& limits, const Clock& clock,
                  const Census& census, Alarm& alarm) {
    if (find_offender(bodies, bodies.first(), bodies.last(), limits, clock, census) != no_row)
        alarm.raise();
}

void guard_motion(WatchedBodies bodies, const Limits& limits, const Clock& clock,
                  const Census& census, const ForceGrid& grid, Overload& overload, Alarm& alarm,
                  Health& health) {
    Row b = no_row;
    if (alarm.raised)
        b = find_offender(bodies, 0, static_cast<Row>(bodies.size()), limits, clock, census);
    for (const Row boundary : census.boundaries)
        if (b == no_row) b = find_offender(bodies, boundary, boundary + 1, limits, clock, census);
    alarm.raised = false;
    const Overload overloaded = std::exchange(overload, {});
    if (health.bad) return; // a contact beyond its limits is the cause
    if (overloaded.body == nobody && b == no_row) return;
    health.bad = true;
    health.what = overloaded.body != nobody
                      ? message_of(overloaded, grid)
                      : fmt::format("body {} ", bodies.column<BodyId>()[b]) +
                            what_moves_wrongly(bodies, b, limits, clock, census);
}

} // namespace bris

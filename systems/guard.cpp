#include "systems/guard.hpp"

#include <fmt/format.h>

#include <limits>

namespace bris {

namespace {

std::string point(const Vec3& x) { return fmt::format("({:g}, {:g}, {:g})", x.x(), x.y(), x.z()); }

} // namespace

void guard_motion(Rows<Bodies, const BodyId, const MotionOf, const Travel, const Position, const Velocity> bodies,
                  const Limits& limits, Health& health) {
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

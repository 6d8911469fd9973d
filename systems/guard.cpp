#include "systems/guard.hpp"

#include <limits>

namespace bris {

void guard_motion(Rows<Bodies, const BodyId, const Travel, const Position, const Velocity> bodies,
                  const Limits& limits, Health& health) {
    const double* travel = bodies.column<Travel>();
    const Vec3* velocity = bodies.column<Velocity>();
    const double limit = limits.speed * limits.speed;
    for (Row b = bodies.first(); b < bodies.last() && !health.bad; ++b) {
        const bool finite = travel[b] < std::numeric_limits<double>::infinity();
        if (finite && velocity[b].squaredNorm() <= limit) continue;
        const double speed = velocity[b].norm();
        const Vec3& x = bodies.column<Position>()[b];
        health.bad = true;
        health.what = "body " + std::to_string(bodies.column<BodyId>()[b]) + " at (" + std::to_string(x.x()) +
                      ", " + std::to_string(x.y()) + ", " + std::to_string(x.z()) +
                      ") m: expected a speed up to " + std::to_string(limits.speed) + " m/s, found " +
                      std::to_string(speed) + "; try a smaller step";
    }
}

} // namespace bris

#include "systems/sleep/sleep.hpp"

namespace bris {

namespace {

template <class BodyRows, class Keep, class RestorePose>
void hold(const BodyRows& bodies, const Sleep& sleep, Keep&& keep, RestorePose&& restore_pose) {
    const auto* motion = bodies.template column<MotionOf>();
    const double *mass = bodies.template column<Mass>(),
                 *radius = bodies.template column<BoundingRadius>();
    const Vec3 *force = bodies.template column<Force>(), *torque = bodies.template column<Torque>();
    Vec3 *velocity = bodies.template column<Velocity>(),
         *omega = bodies.template column<AngularVelocity>(),
         *step_omega = bodies.template column<StepAngularVelocity>();
    std::uint32_t* resting = bodies.template column<Resting>();
    HeldRow* held = bodies.template column<HeldPose>();
    Vec3* position = bodies.template column<Position>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        if (motion[b] != static_cast<std::uint32_t>(Motion::free)) continue;
        const bool slept = resting[b] >= sleep.steps && held[b].held != 0;
        const double limit = (slept ? 2 : 1) * sleep.acceleration * mass[b];
        const bool balanced = force[b].squaredNorm() <= limit * limit &&
                              torque[b].squaredNorm() <= limit * limit * radius[b] * radius[b];
        if (!slept) {
            const double slow = sleep.speed * sleep.speed,
                         turning = radius[b] * radius[b] * step_omega[b].squaredNorm();
            const bool rests = balanced && velocity[b].squaredNorm() <= slow && turning <= slow;
            resting[b] = rests ? resting[b] + 1 : 0;
            if (resting[b] < sleep.steps) continue;
            held[b].position = position[b];
            held[b].held = 1;
            keep(held[b], b);
        } else if ((sleep.all || sleep.busy[b] != 0) && !balanced) {
            resting[b] = 0;
            held[b].held = 0;
            continue;
        } else if (resting[b] < sleep.steps + Sleep::settling) {
            ++resting[b];
        }
        position[b] = held[b].position;
        restore_pose(held[b], b);
        velocity[b] = omega[b] = step_omega[b] = Vec3::Zero();
        bodies.template column<Acceleration>()[b] = bodies.template column<AngularMomentum>()[b] =
            Vec3::Zero();
    }
}

} // namespace

void hold_spheres(RestingBodies<const SphereInertia> bodies, const Sleep& sleep) {
    hold(
        bodies, sleep, [](HeldRow&, Row) {}, [](const HeldRow&, Row) {});
}

void hold_clumps(RestingBodies<Orientation> bodies, const Sleep& sleep) {
    Quat* orientation = bodies.column<Orientation>();
    hold(
        bodies, sleep,
        [&](HeldRow& h, Row b) {
            h.qx = orientation[b].x();
            h.qy = orientation[b].y();
            h.qz = orientation[b].z();
            h.qw = orientation[b].w();
        },
        [&](const HeldRow& h, Row b) { orientation[b] = Quat(h.qw, h.qx, h.qy, h.qz); });
}

} // namespace bris

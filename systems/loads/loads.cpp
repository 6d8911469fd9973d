#include "systems/loads/loads.hpp"

namespace bris {

namespace {

/// Mean velocities of a free body over the kick of a step.
struct MeanMotion {
    Vec3 velocity, angular_velocity;
};

template <class BodyRows>
MeanMotion mean_motion(const BodyRows& bodies, Row b, double dt) {
    const Quat& q = bodies.template column<Orientation>()[b];
    const Vec3 momentum = bodies.template column<AngularMomentum>()[b] +
                          0.5 * dt * bodies.template column<Torque>()[b];
    const Vec3 local =
        (q.conjugate() * momentum).cwiseQuotient(bodies.template column<InertialInertia>()[b]);
    return {bodies.template column<Velocity>()[b] + 0.5 * dt * bodies.template column<Force>()[b] /
                                                        bodies.template column<InertialMass>()[b],
            q * local};
}

/// The point of a patch and its speed along the patch's axis at the time of the positions.
struct PatchAt {
    Vec3 arm;
    double displaced, speed;
};

template <class BodyRows>
PatchAt locate(const BodyRows& bodies, Row b, const SpringPatch& p, double dt) {
    const Vec3 arm = bodies.template column<Orientation>()[b] * p.point;
    const Vec3 velocity = bodies.template column<Velocity>()[b] +
                          0.5 * dt * bodies.template column<Acceleration>()[b] +
                          bodies.template column<AngularVelocity>()[b].cross(arm);
    return {arm, p.displacement(bodies.template column<Position>()[b] + arm), velocity.dot(p.axis)};
}

} // namespace

void apply_loads(Rows<Bodies, const LoadOf, const Orientation, Force, Torque, LoadForce> bodies,
                 const Loads& loads, const Clock& clock) {
    const std::uint32_t* number = bodies.column<LoadOf>();
    const Quat* orientation = bodies.column<Orientation>();
    Vec3 *force = bodies.column<Force>(), *torque = bodies.column<Torque>();
    Wrench* total = bodies.column<LoadForce>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        if (number[b] == 0) continue;
        Wrench sum;
        for (const Load& load : loads.of_body[number[b] - 1]) {
            const double now = load.history.at(clock.time());
            sum.force += now * load.force;
            sum.torque += now * (load.couple + (orientation[b] * load.point).cross(load.force));
        }
        force[b] += sum.force;
        torque[b] += sum.torque;
        total[b] = sum;
    }
}

void push_patches(Rows<Bodies, const PatchesOf, const Position, const Velocity, const Acceleration,
                       const AngularVelocity, const Orientation, Force, Torque, PatchForce>
                      bodies,
                  const SpringPatches& patches, const Clock& clock) {
    const std::uint32_t* number = bodies.column<PatchesOf>();
    Vec3 *force = bodies.column<Force>(), *torque = bodies.column<Torque>();
    Wrench* total = bodies.column<PatchForce>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        if (number[b] == 0) continue;
        Wrench sum;
        for (const SpringPatch& p : patches.of_body[number[b] - 1]) {
            const PatchAt at = locate(bodies, b, p, clock.dt);
            const Vec3 f = p.force(at.displaced, at.speed) * p.axis;
            sum.force += f;
            sum.torque += at.arm.cross(f);
        }
        force[b] += sum.force;
        torque[b] += sum.torque;
        total[b] = sum;
    }
}

void accumulate_load_work(Rows<Bodies, const LoadOf, const LoadForce, const Force, const Torque,
                               const Velocity, const AngularMomentum, const InertialMass,
                               const InertialInertia, const Orientation, LoadWork>
                              bodies,
                          const Clock& clock) {
    const std::uint32_t* number = bodies.column<LoadOf>();
    const Wrench* load = bodies.column<LoadForce>();
    double* work = bodies.column<LoadWork>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        if (number[b] == 0) continue;
        const MeanMotion mean = mean_motion(bodies, b, clock.dt);
        work[b] += clock.dt *
                   (load[b].force.dot(mean.velocity) + load[b].torque.dot(mean.angular_velocity));
    }
}

void accumulate_patch_work(
    Rows<Bodies, const PatchesOf, const Position, const Force, const Torque, const Velocity,
         const Acceleration, const AngularVelocity, const AngularMomentum, const InertialMass,
         const InertialInertia, const Orientation, PatchWork>
        bodies,
    const SpringPatches& patches, const Clock& clock) {
    const std::uint32_t* number = bodies.column<PatchesOf>();
    double* work = bodies.column<PatchWork>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        if (number[b] == 0) continue;
        const MeanMotion mean = mean_motion(bodies, b, clock.dt);
        for (const SpringPatch& p : patches.of_body[number[b] - 1]) {
            const PatchAt at = locate(bodies, b, p, clock.dt);
            // what the patch exerts beyond its spring is the dashpot's
            const double damping = p.force(at.displaced, at.speed) - p.force(at.displaced, 0);
            const Vec3 moved = mean.velocity + mean.angular_velocity.cross(at.arm);
            work[b] -= clock.dt * damping * moved.dot(p.axis);
        }
    }
}

} // namespace bris

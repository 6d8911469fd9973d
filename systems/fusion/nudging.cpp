#include "systems/fusion/nudging.hpp"

#include "engine/signal/attitude.hpp"
#include "systems/fusion/guided_bodies.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double largest_angle = 0.5; // rad, w dt of a spring

Vec3 at_most(const Vec3& v, double largest) {
    return v.norm() > largest ? Vec3(largest / v.norm() * v) : v;
}

/// State at the beginning of a step of critically damped motion, in axes along which the masses
/// (kg) or moments of inertia (kg m2) are known.
struct Approach {
    Vec3 displacement; ///< m or rad, from the body to the target
    Vec3 momentum;     ///< relative to the target, half a step back
    Vec3 others;       ///< N or N m, other forces or torques of this step
    Vec3 mass;
};

Vec3 critically_damped(const Approach& a, double stiffness, double largest, double dt) {
    const double k =
        std::min(stiffness, a.mass.minCoeff() * largest_angle * largest_angle / (dt * dt));
    const Vec3 spring = at_most(k * a.displacement, largest),
               dashpot = 2 * (k * a.mass).cwiseSqrt();
    const Vec3 velocity =
        (a.momentum + 0.5 * dt * (a.others + spring)).cwiseQuotient(a.mass + 0.5 * dt * dashpot);
    return at_most(spring - dashpot.cwiseProduct(velocity), largest);
}

/// Nudging of spheres and clumps, which differ only in the torque. `torque_of`: called with a
/// body's row and its NudgingRow.
template <class BodyRows, class TorqueOf>
void nudge_guided(const BodyRows& bodies, const Clock& clock, TorqueOf&& torque_of) {
    const Vec3 *position = bodies.template column<Position>(),
               *velocity = bodies.template column<Velocity>(),
               *angular_velocity = bodies.template column<StepAngularVelocity>();
    const double* mass = bodies.template column<InertialMass>();
    NudgingRow* nudging = bodies.template column<Nudging>();
    Vec3 *force = bodies.template column<Force>(), *torque = bodies.template column<Torque>();
    double* work = bodies.template column<FusionWork>();
    for_guided(bodies, [&](Row b) {
        NudgingRow& p = nudging[b];
        const Vec3 force_before = p.force, torque_before = p.torque;
        if (!p.is_active()) {
            p.force = p.torque = Vec3::Zero();
        } else if (p.held == 0) {
            const double m = mass[b];
            const Approach approach{p.position - position[b], m * (velocity[b] - p.velocity),
                                    force[b], Vec3::Constant(m)};
            p.force = critically_damped(approach, p.stiffness, p.largest_force, clock.dt);
            p.torque = torque_of(b, p);
            p.position += clock.dt * p.velocity;
        }
        work[b] += 0.5 * clock.dt *
                   ((force_before + p.force).dot(velocity[b]) +
                    (torque_before + p.torque).dot(angular_velocity[b]));
        force[b] += p.force;
        torque[b] += p.torque;
    });
}

} // namespace

void nudge_spheres(Rows<Bodies, const Guided, const Position, const Velocity, const InertialMass,
                        const AngularMomentum, const StepAngularVelocity, const SphereInertia,
                        Nudging, Force, Torque, FusionWork>
                       bodies,
                   const Clock& clock) {
    const Vec3 *momentum = bodies.column<AngularMomentum>(),
               *angular_velocity = bodies.column<StepAngularVelocity>(),
               *torque = bodies.column<Torque>();
    const double* inertia = bodies.column<SphereInertia>();
    nudge_guided(bodies, clock, [&](Row b, NudgingRow& p) -> Vec3 {
        // The remaining rotation is updated by how the sphere has rotated in the last step, and the
        // target by its angular velocity s. In global axes it leads from the sphere to the target:
        // target = attitude * body, so
        // exp(dt s) target = (exp(dt s) attitude exp(-dt w)) exp(dt w) body.
        p.attitude = (exponential_map(clock.dt * p.angular_velocity) * p.attitude *
                      exponential_map(-clock.dt * angular_velocity[b]))
                         .normalized();
        const Approach approach{rotation_vector(p.attitude),
                                momentum[b] - inertia[b] * p.angular_velocity, torque[b],
                                Vec3::Constant(inertia[b])};
        return critically_damped(approach, p.turn_stiffness, p.largest_torque, clock.dt);
    });
}

void nudge_clumps(Rows<Bodies, const Guided, const Position, const Velocity, const InertialMass,
                       const AngularMomentum, const StepAngularVelocity, const Orientation,
                       const InertialInertia, Nudging, Force, Torque, FusionWork>
                      bodies,
                  const Clock& clock) {
    const Vec3 *momentum = bodies.column<AngularMomentum>(), *torque = bodies.column<Torque>(),
               *inertia = bodies.column<InertialInertia>();
    const Quat* orientation = bodies.column<Orientation>();
    nudge_guided(bodies, clock, [&](Row b, NudgingRow& p) -> Vec3 {
        const Quat to_body = orientation[b].conjugate();
        const Vec3 angular_velocity = to_body * p.angular_velocity,
                   displacement = to_body * attitude_error(p.attitude, orientation[b]),
                   others = to_body * torque[b];
        const Approach approach{displacement,
                                to_body * momentum[b] - inertia[b].cwiseProduct(angular_velocity),
                                others, inertia[b]};
        p.attitude = (exponential_map(clock.dt * p.angular_velocity) * p.attitude).normalized();
        return orientation[b] *
               critically_damped(approach, p.turn_stiffness, p.largest_torque, clock.dt);
    });
}

void set_nudging(NudgingRow& row, std::uint32_t& guided, const NudgingTarget& target,
                 const NudgingSettings& settings) {
    row.position = target.position;
    row.velocity = target.velocity;
    row.attitude = target.attitude;
    row.angular_velocity = target.angular_velocity;
    row.stiffness = settings.stiffness;
    row.turn_stiffness = row.stiffness * settings.arm * settings.arm;
    row.largest_force = settings.largest_force;
    row.largest_torque = row.largest_force * settings.arm;
    row.held = 0;
    guided = 1;
}

void hold_nudging_forces(World& world) {
    for (NudgingRow& row : world.column<Bodies, Nudging>())
        if (row.is_active()) row.held = 1;
}

} // namespace bris

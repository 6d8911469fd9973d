#include "systems/loads/nudging.hpp"

#include "engine/clock.hpp"
#include "engine/signal/attitude.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

// The nudging force on a body of inertial mass m (scaled or not), at a displacement d from its
// target and with a velocity v relative to the target, is
//     F = S - c v,   S = k d, |S| <= F_max,   c = 2 sqrt(k m),   |F| <= F_max.
// The distance of a free body from its target decays from rest as (1 + w t) exp(-w t), with
// w = sqrt(k / m), without overshoot. Because S has a limit of its own, a distant body approaches
// no faster than F_max / c, and from that speed the dashpot can stop it in time; a limit on the sum
// alone would not ensure this. v is the velocity at the time of the position and includes the
// dashpot's own contribution to the kick. This is of second order in dt; the roots of a step are
// 1 - w dt and 1 / (1 + w dt), so there is no overshoot for w dt up to 1. Torques follow the same
// formula about each principal axis, with its moment of inertia. In contact, neighbours add mass
// and stiffness, so the motion is damped more or less than critically.

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

/// Adds the nudging forces and torques, and accumulates the work of spring and dashpot over the
/// last step (trapezoidal rule, as for boundaries). Spheres and clumps differ only in the torque.
/// `torque_of`: called with a body's row and its NudgingRow.
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

} // namespace

StepList Nudging::force_systems() {
    return {row_local("nudge_spheres", nudge_spheres), row_local("nudge_clumps", nudge_clumps)};
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

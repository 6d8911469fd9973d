#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/sensor.hpp"
#include "engine/clock.hpp"
#include "engine/rows.hpp"
#include "engine/world.hpp"

namespace bris {

/// Nudging instead of direct insertion: a spring towards the target pose, up to a force at which
/// contacts yield, and a dashpot that makes the motion critically damped (Den Hartog, Mechanical
/// Vibrations, 1956, chapter 2).
struct NudgingSettings {
    /// N/m; 0: direct insertion instead of nudging. Larger values than m (0.5 / dt)^2, which the
    /// time step still resolves, act as that value.
    double stiffness = 0;
    double largest_force = 0; ///< N, limit of the spring force and of the sum with the dashpot
    double arm = 0.01; ///< m, lever arm that converts stiffness and force to those of rotation
};

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

/// Adds the nudging forces and torques, and accumulates the work of spring and dashpot over the
/// last step (trapezoidal rule, as for boundaries).
void nudge_spheres(Rows<Bodies, const Guided, const Position, const Velocity, const InertialMass,
                        const AngularMomentum, const StepAngularVelocity, const SphereInertia,
                        Nudging, Force, Torque, FusionWork>
                       bodies,
                   const Clock& clock);
void nudge_clumps(Rows<Bodies, const Guided, const Position, const Velocity, const InertialMass,
                       const AngularMomentum, const StepAngularVelocity, const Orientation,
                       const InertialInertia, Nudging, Force, Torque, FusionWork>
                      bodies,
                  const Clock& clock);

/// Target pose of a body and the velocities of the target.
struct NudgingTarget {
    Vec3 position, velocity; ///< m, m/s
    /// Of a sphere: the remaining rotation one step ago, which nudge_spheres advances over that
    /// step.
    Quat attitude;
    Vec3 angular_velocity; ///< rad/s
};

/// Nudges a body towards the target from now on.
void set_nudging(NudgingRow& row, std::uint32_t& guided, const NudgingTarget& target,
                 const NudgingSettings& settings);

/// Keeps the force and torque of all nudging constant from now on, because the targets are no
/// longer known: to be called before the platens of a staged test move.
void hold_nudging_forces(World& world);

} // namespace bris

#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/sensor.hpp"
#include "engine/clock.hpp"
#include "engine/rows.hpp"
#include "engine/world.hpp"

namespace bris {

/// Pulling instead of putting: a spring to where the body should be, up to a force at which
/// contacts yield, with a dashpot that makes it critically damped (Den Hartog, Mechanical
/// Vibrations, 1956, chapter 2).
struct NudgingSettings {
    double stiffness =
        0; ///< N/m; 0: bodies are put. At most m (0.5 / dt)^2, where a step still follows it
    double largest_force = 0; ///< N, of the spring alone and of both together
    double arm = 0.01;        ///< m: torques are as forces at this arm
};

// The force on a body of mass m that is `way` from where it should be, and moves by v beside how
// that moves on, is
//     F = S - c v,   S = k way, |S| <= F_max,   c = 2 sqrt(k m),   |F| <= F_max,
// with m its inertial mass, scaled or not: alone and from rest it arrives by (1 + w t) exp(-w t), w
// = sqrt(k / m), and never goes beyond. Since S has the limit by itself, it comes from afar no
// faster than F_max / c, from which the dashpot can stop it in time; with a limit on the sum alone
// it would not. v is of the time of the place, with the dashpot's own part of the kick: of second
// order in dt, roots of a step 1 - w dt and 1 / (1 + w dt), so without overshoot for w dt up to 1.
// Torques likewise, about each principal axis by its own moment of inertia. Neighbours add mass and
// springs of their own: in contact it is damped by less or more.

/// Adds the pulls to the forces, and books their work, spring and dashpot, over the last step
/// (trapezoidal rule, as that of boundaries).
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

/// Where a body should be, and how it should move on there.
struct NudgingTarget {
    Vec3 position, velocity; ///< m, m/s
    Quat attitude; ///< of a sphere: the rotation to go a step before, which nudge_spheres carries
                   ///< over that step
    Vec3 angular_velocity; ///< rad/s
};

/// Pulls a body there from now on. `gain`: of stiffness and largest force, 0 to 1; 0: nothing pulls
/// any more.
void set_nudging(NudgingRow& row, std::uint32_t& guided, const NudgingTarget& target,
                 const NudgingSettings& settings, double gain);

/// From now on force and torque stay as they are: where the body should be is not known any more.
void hold_nudging(NudgingRow& row);

/// Nothing pulls any more.
void release_nudging(NudgingRow& row);

} // namespace bris

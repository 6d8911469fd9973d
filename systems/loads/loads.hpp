#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/load.hpp"
#include "engine/clock.hpp"
#include "engine/rows.hpp"

namespace bris {

/// Adds the loads on bodies to their forces, with the histories at the time of the positions.
void apply_loads(Rows<Bodies, const LoadOf, const Orientation, Force, Torque, LoadForce> bodies,
                 const Loads& loads, const Clock& clock);

/// Adds the forces of springs and dashpots between bodies and the ground. The velocity of a dashpot
/// is predicted with the last acceleration, as that of a contact is.
void push_patches(Rows<Bodies, const PatchesOf, const Position, const Velocity, const Acceleration,
                       const AngularVelocity, const Orientation, Force, Torque, PatchForce>
                      bodies,
                  const SpringPatches& patches, const Clock& clock);

/// Accumulates the work of the loads in this step, with the mean of the velocities before and after
/// the kick: that is the work which the leapfrog itself does. To be called when Force and Torque
/// are complete.
void accumulate_load_work(Rows<Bodies, const LoadOf, const LoadForce, const Force, const Torque,
                               const Velocity, const AngularMomentum, const InertialMass,
                               const InertialInertia, const Orientation, LoadWork>
                              bodies,
                          const Clock& clock);

/// The same for the energy that the dashpots of patches dissipate.
void accumulate_patch_work(
    Rows<Bodies, const PatchesOf, const Position, const Force, const Torque, const Velocity,
         const Acceleration, const AngularVelocity, const AngularMomentum, const InertialMass,
         const InertialInertia, const Orientation, PatchWork>
        bodies,
    const SpringPatches& patches, const Clock& clock);

} // namespace bris

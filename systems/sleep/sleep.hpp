#pragma once

#include "components/kinds.hpp"
#include "components/sleep.hpp"
#include "engine/rows.hpp"

namespace bris {

// Sleeping: who rests, what of him is left out of the step. Scenes without the resource Sleep have
// none of this.

/// Lets the bodies of a scene sleep; before its schedule is made. Throws InputError unless its
/// boundaries are planes that stand still, and where an energy ledger is kept, which would miss
/// what little sleepers had.
void add_sleep(World& world, const Sleep& settings);

/// Wakes all, as whoever changes weight, materials, boundaries or bodies by hand has to.
void wake_all(World& world);

/// Bodies that sleep now.
std::size_t sleepers(const World& world);

/// Whether somebody has fallen asleep or woken.
bool sleep_is_due(const World& world);
/// Tells contacts and row-local systems which pairs and bodies to leave out; then, and where lists
/// are made anew.
void review_sleep(World& world, Sleep& sleep);

template <class... Shape>
using RestingBodies = Rows<Bodies, const MotionOf, const Mass, const BoundingRadius, const Force,
                           const Torque, Resting, HeldPose, Position, Velocity, Acceleration,
                           AngularVelocity, StepAngularVelocity, AngularMomentum, Shape...>;

/// After the motion of a step: counts who was at rest, holds who sleeps, lets go who is pushed.
void hold_spheres(RestingBodies<const SphereInertia> bodies, const Sleep& sleep);
void hold_clumps(RestingBodies<Orientation> bodies, const Sleep& sleep);

} // namespace bris

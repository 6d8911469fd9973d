#pragma once

#include "components/kinds.hpp"
#include "components/sleep.hpp"
#include "engine/rows.hpp"

namespace bris {

// Sleeping: which bodies are at rest, and which parts of the step skip them. Scenes without the
// resource Sleep have none of these systems.

/// Lets the bodies of a scene sleep. To be called before its schedule is made. Throws InputError
/// unless all boundaries are fixed planes; where there are sensors, whose corrections would be lost
/// on sleeping bodies; and where there is an energy budget, which would miss the energy that bodies
/// lose when they fall asleep.
void add_sleep(World& world, const Sleep& settings);

/// Wakes all bodies. To be called after a change of gravity, materials, boundaries or bodies from
/// outside the step.
void wake_all(World& world);

/// Number of sleeping bodies.
std::size_t sleepers(const World& world);

/// True if a body has fallen asleep or woken since the last review.
bool sleep_is_due(const World& world);
/// Determines which pairs and bodies the contact kernels and row-local systems skip. Runs when
/// sleep_is_due, and when the lists are made anew.
void review_sleep(World& world, Sleep& sleep);

template <class... Shape>
using RestingBodies = Rows<Bodies, const MotionOf, const Mass, const BoundingRadius, const Force,
                           const Torque, Resting, HeldPose, Position, Velocity, Acceleration,
                           AngularVelocity, StepAngularVelocity, AngularMomentum, Shape...>;

/// After the motion of a step: counts the steps at rest of each body, holds the sleeping bodies in
/// place and wakes those whose forces are out of balance.
void hold_spheres(RestingBodies<const SphereInertia> bodies, const Sleep& sleep);
void hold_clumps(RestingBodies<Orientation> bodies, const Sleep& sleep);

} // namespace bris

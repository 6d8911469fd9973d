#pragma once

#include "components/material.hpp"
#include "engine/world.hpp"

namespace bris {

/// Checks that a scene is physically valid, at the start of a run: materials within their ranges
/// and with all properties that the law needs, free bodies with mass and inertia, finite positions,
/// velocities, limits and time step. Throws InputError, one line with the name, the expected range
/// and what was found.
void check_scene(const World& world, LawName law);

/// Checks that no sphere overlaps another sphere or a boundary at the start by more than
/// Limits::overlap; coincident centres count as the largest overlap. Throws InputError with the
/// pair of largest relative overlap. The scene must be complete and have its pair lists, which are
/// rebuilt in the first step. Of a divided world each rank gives its part.
void check_overlaps(World& world);

/// Checks the time step of a scene before its first step, in which nothing needs to touch yet.
/// Throws InputError, naming --step, if it is longer than the stable step of a first contact.
void check_first_step(const World& world);

/// Throws SimulationError, naming --step, if the time step is longer than the stable step of the
/// contacts that have formed, or than a `stable` step (s) that is known.
void check_stable_step(const World& world);
void check_stable_step(const World& world, double stable);

} // namespace bris

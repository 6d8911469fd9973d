#pragma once

#include "components/material.hpp"
#include "engine/system.hpp"

namespace bris {

/// The systems of one time step, in order. The order defines the result; the schedule may run
/// neighbours that share no data at the same time, and leaves out the systems that a scene does not
/// need. With `energy_budget`, the work of friction, dashpots, rolling, local damping and
/// boundaries is accumulated. `patch` must be that of the scene's ContactPolicy.
StepList steps(LawName law, bool energy_budget = false,
               PatchStiffness patch = PatchStiffness::per_sphere);

/// Whether the next step of a world that is divided among ranks needs all bodies: it brings fields
/// up to date, or assimilates the recordings of sensors (Division).
bool whole_step_is_due(const World& world);
/// Whether no body with spheres is held by a spring to the ground, whose energy one rank alone
/// would know (Division). All ranks ask.
bool can_be_observed(const World& part);

} // namespace bris

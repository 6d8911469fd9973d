#pragma once

#include "components/material.hpp"
#include "engine/system.hpp"

namespace bris {

/// One step of the simulation, in order. The order is the meaning; the schedule may overlap
/// neighbours that touch nothing in common, and leaves out whatever a scene does not need.
/// With `energy_budget`, friction, dashpots, rolling, local damping and the boundaries book their
/// work. With `patch` shared, so do the patches of clumps (the scene's ContactPolicy says so too).
StepList steps(LawName law, bool energy_budget = false,
               PatchStiffness patch = PatchStiffness::per_sphere);

} // namespace bris

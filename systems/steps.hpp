#pragma once

#include "components/material.hpp"
#include "engine/system.hpp"

namespace bris {

/// The systems of one step of the simulation, in order. The order defines the result; the schedule
/// may overlap neighbours that share no data, and leaves out the systems that a scene does not
/// need. With `energy_budget`, the work of friction, dashpots, rolling, local damping and
/// boundaries is accumulated. With `patch` shared, the contacts of a clump's patch share one
/// stiffness; the scene's ContactPolicy must say the same.
StepList steps(LawName law, bool energy_budget = false,
               PatchStiffness patch = PatchStiffness::per_sphere);

} // namespace bris

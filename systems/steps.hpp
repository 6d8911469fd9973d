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

} // namespace bris

#pragma once

#include "engine/system.hpp"
#include "systems/contact/laws/law.hpp"

namespace bris {

/// One step of the simulation, in order. The order is the meaning; the schedule may overlap
/// neighbours that touch nothing in common, and leaves out whatever a scene does not need.
/// With `ledger`, friction, local damping and the boundaries book their work (undamped laws).
StepList steps(LawName law, bool ledger = false);

} // namespace bris

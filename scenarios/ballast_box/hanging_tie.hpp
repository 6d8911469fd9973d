#pragma once

#include "engine/world.hpp"
#include "scenarios/ballast_box/train.hpp"

namespace bris {

// A tie that hangs on the rails above its ballast, as ties do at mud spots. The rails push it with
// K (w - u) less its weight: u is the deflection of the tie and w that of the rails where the bed
// does not carry this tie, both from where it hangs, and K is TrackRail::stiffness_without. So
// the tie takes load when its gap has closed, and the less the softer its ballast is.

/// Lifts the tie of a bay by `gap` (m, > 0) and hangs it on the rails: a spring and a dashpot of a
/// tenth of critical damping with this tie, and an upward load of its weight. `share`: part of a
/// whole tie that is modelled.
void hang_tie(World& world, const RailOnTies& rails, double share, double gap);

/// The load (N, downwards) on a whole tie that hangs while a train passes, to which the spring of
/// hang_tie adds; otherwise as passing_load. `weight`: N, of the tie.
LoadHistory passing_load_of_hanging_tie(const Train& train, double speed, const RailOnTies& rails,
                                        double dead_load, double weight);

/// N, weight of the tie of a bay, of the modelled part.
double weight_of_tie(const World& world);

} // namespace bris

#pragma once

#include "engine/world.hpp"
#include "scenarios/ballast_box/train.hpp"

namespace bris {

// A tie that hangs on the rails above its ballast, as ties do at mud spots, while all others lie on
// springs. The rails push it downwards with K (w - u) + C d(w - u)/dt less its weight: u is its
// deflection and w that of the rails where the bed does not carry this tie, both from where it
// hangs; K are rails and pads in series, C is a tenth of critical damping with this tie. So the tie
// takes load when its gap has closed, and the less the softer its ballast is.

/// N/m, K for a whole tie.
double stiffness_above_tie(const RailOnTies& rails);

/// Lifts the tie of a bay by `gap` (m, > 0) and hangs it on the rails: a spring, a dashpot and an
/// upward load of its weight. `share`: part of a whole tie that is modelled.
void hang_tie(World& world, const RailOnTies& rails, double share, double gap);

/// The load (N, downwards) on a whole tie that hangs while a train passes, K w + C dw/dt less its
/// weight, to which the spring and the dashpot of hang_tie add the rest; otherwise as passing_load.
/// `of_rails`: N, weight of rails and fastenings on each tie; `mass`: kg, of the whole tie;
/// `gravity`: m/s2.
LoadHistory passing_load_of_hanging_tie(const Train& train, double speed, const RailOnTies& rails,
                                        double of_rails, double mass, double gravity = 9.81);

/// m, of the middle of the tie of a bay or slice.
double height_of_tie(const World& world);

/// kg, mass of the tie of a bay, of the modelled part.
double mass_of_tie(const World& world);

/// Notes the force of the ballast on the tie and its height, while the last axle stands on it.
void note_pressed_tie(World& world);
/// The secant stiffness (N/m, of a whole tie) of unloading from there until now, when the train has
/// gone, becomes BoxState::bed_stiffness. If it is not that of any ballast, a line is printed, and
/// the stiffness remains as it was.
void note_bed_stiffness(World& world, double share);

} // namespace bris

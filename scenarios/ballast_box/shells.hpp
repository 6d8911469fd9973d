#pragma once

#include "engine/world.hpp"
#include "scenarios/ballast_box/box_settings.hpp"

namespace bris {

/// Gives the sensor rocks of a bay the density and friction of their shells, which were those of
/// the rocks while the bed was made, so that different shells are compared in the same packing. The
/// density is the mean of a sensor rock with all that is in it. The time step must be chosen after
/// this, and BoxBodies::hard has the new friction. Called again, it changes nothing.
void change_shells(World& world, const BallastBox& box);

} // namespace bris

#pragma once

#include "engine/world.hpp"

namespace bris {

/// Adds the columns of the energy budget to a scene that already has its neighbour lists
/// (add_lists).
void add_energy_budget(World& world);

} // namespace bris

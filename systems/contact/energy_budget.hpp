#pragma once

#include "engine/world.hpp"

namespace bris {

/// Adds the columns of the energy ledger to a scene that has its lists (add_lists).
void add_energy_budget(World& world);

} // namespace bris

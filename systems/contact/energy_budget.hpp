#pragma once

#include "engine/world.hpp"

namespace bris {

/// Adds the columns of the energy budget to a scene that already has its neighbour lists
/// (add_lists).
void add_energy_budget(World& world);

/// Energy (J) that contacts have dissipated since the start, by friction, dashpots, rolling and
/// edges that yield; 0 without an energy budget.
double dissipated_in_contacts(const World& world);

} // namespace bris

#pragma once

#include "engine/archive.hpp"
#include "engine/world.hpp"

namespace bris {

/// All State of a world: every State column in the order of the table's key, then the resources.
/// The same bits whatever the rows' order in memory.
Archive save_state(const World& world);

/// Puts a world of the same scene into a saved state; rows then stand in key order and everything
/// Derived is to be made anew. Throws InputError if the archive does not fit the scene.
void load_state(World& world, const Archive& archive);

} // namespace bris

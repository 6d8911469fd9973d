#pragma once

#include "engine/archive.hpp"
#include "engine/world.hpp"

namespace bris {

/// All State of a world: every State column in the order of the table's key, then the resources.
/// The bits do not depend on the order of the rows in memory.
Archive save_state(const World& world);

/// Loads a saved state into a world of the same scene. Afterwards the rows are in key order, and
/// everything Derived must be recomputed. Throws InputError if the archive does not match the
/// scene.
void load_state(World& world, const Archive& archive);

} // namespace bris

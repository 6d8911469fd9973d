#pragma once

#include "engine/archive.hpp"
#include "engine/world.hpp"

namespace bris {

/// The State of a world (StateOfWorld), all of it in memory.
Archive save_state(const World& world);

/// Loads a saved state into a world of the same scene. Afterwards the rows are in key order, and
/// everything Derived must be recomputed. Throws InputError if the archive does not match the
/// scene.
void load_state(World& world, const Archive& archive);

/// Adds the State columns of a world that an archive lacks, filled with zeros: the state of a scene
/// whose contacts had less history than those of this world.
void add_absent_columns(Archive& archive, const World& world);

} // namespace bris

#pragma once

#include "engine/archive.hpp"
#include "engine/world.hpp"

namespace bris {

/// The bodies, spheres, planes, membrane, materials and fields of a checkpoint of any scenario, to
/// be measured; it cannot be simulated. Throws InputError if the archive holds no scene.
World world_of_state(const Archive& state);

} // namespace bris

#pragma once

#include "engine/world.hpp"
#include "scenarios/ballast_box/box_scene.hpp"

#include <cstdint>

namespace bris {

/// Releases the rocks of a course: at random places above the ballast, in a column so tall that
/// their bounding spheres do not touch. Sensor rocks that belong on the course before are laid onto
/// its surface first.
void pour_course(World& world, const BoxSizes& sizes, std::size_t course, std::uint64_t seed);

} // namespace bris

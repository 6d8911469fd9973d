#pragma once

#include "components/material.hpp"
#include "engine/world.hpp"

namespace bris {

/// Refuses a scene that no law of mechanics describes: materials of bodies outside their range or
/// without what the law needs, bodies without mass, inertia or a place, limits and a step that are
/// no numbers. Throws InputError, one line: the name, the range expected, what was found. For the
/// start of a run.
void check_scene(const World& world, LawName law);

/// Refuses a start in which spheres stand in each other or in a boundary deeper than
/// Limits::overlap, or have the same centre. Throws InputError: the deepest pair. For a complete
/// scene that has its lists (they are made once more in the first step).
void check_overlaps(World& world);

} // namespace bris

#pragma once

#include "engine/entity.hpp"
#include "engine/world.hpp"

#include <vector>

namespace bris {

/// Takes free bodies out of a scene between two steps, with their spheres and their contacts: they
/// cost nothing any more. The ids of the others close up in their order, so sums keep theirs; entry
/// i of the result is the new id of body i, nobody if it went. Whoever keeps ids of bodies has to
/// be told. `gone`: rows of Bodies, any order. The lists are made anew before the next step,
/// springs carried over; contacts are unknown until then.
std::vector<EntityId> retire_bodies(World& world, const std::vector<Row>& gone);

} // namespace bris

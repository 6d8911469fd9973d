#pragma once

#include "engine/entity.hpp"
#include "engine/world.hpp"

#include <vector>

namespace bris {

/// Removes free bodies from a scene between two steps, with their spheres and contacts, so that
/// they cost no more time. The other bodies are renumbered without gaps in the order of their ids,
/// which keeps the order of all sums. Returns the new id of each body by its old id, `nobody` for
/// removed bodies; ids that are stored elsewhere must be updated by it. `gone`: rows of Bodies in
/// any order. The pair lists are rebuilt before the next step and keep the contact springs; until
/// then contacts are unknown. Throws InputError if the scene has sensors or a body is not free.
std::vector<EntityId> retire_bodies(World& world, const std::vector<Row>& gone);

} // namespace bris

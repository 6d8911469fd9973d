#pragma once

#include "engine/entity.hpp"
#include "engine/world.hpp"

#include <span>
#include <vector>

namespace bris {

/// Largest overlap (m) of each body in the last step, by row.
std::vector<double> largest_overlaps(const World& world);

/// Gives the spheres of some rocks the size that their Growth says.
void resize_rocks(World& world, std::span<const EntityId> rocks);

/// Lets rocks grow by `factor`, those excepted that overlap by more than `limit` of their bounding
/// radius; true when all have full size.
bool grow_rocks(World& world, std::span<const EntityId> rocks, double factor, double limit);

} // namespace bris

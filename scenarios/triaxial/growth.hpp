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

/// Lets rocks grow by `factor`, those excepted whose overlap (`squeezed`, of largest_overlaps) is
/// more than `limit` of their bounding radius; true when all have full size.
bool grow_rocks(World& world, std::span<const EntityId> rocks, std::span<const double> squeezed,
                double factor, double limit);

} // namespace bris

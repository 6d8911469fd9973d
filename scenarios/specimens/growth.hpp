#pragma once

#include "engine/entity.hpp"
#include "engine/world.hpp"

#include <span>
#include <vector>

namespace bris {

/// Largest overlap (m) of each body in the last step, by row.
std::vector<double> largest_overlaps(const World& world);

/// Gives the spheres of these rocks the size that the rocks' Growth prescribes.
void resize_rocks(World& world, std::span<const EntityId> rocks);

/// Grows rocks by `factor`, except those whose overlap (`squeezed`, from largest_overlaps) exceeds
/// `limit` times their bounding radius. Returns true when all rocks have their full size.
bool grow_rocks(World& world, std::span<const EntityId> rocks, std::span<const double> squeezed,
                double factor, double limit);

} // namespace bris

#pragma once

#include "engine/entity.hpp"
#include "engine/world.hpp"

#include <span>
#include <vector>

namespace bris {

/// How bodies grow in place: fraction of their full size at which they are placed at random without
/// touching, relative growth in a step of those that have room, and overlap over radius at which
/// one waits until it has room.
inline constexpr double first_scale = 0.45, growth_per_step = 2e-4, squeezing_limit = 2e-3;

/// Largest overlap (m) of each body in the last step, by row.
std::vector<double> largest_overlaps(const World& world);

/// Gives the spheres of these rocks the size that the rocks' Growth prescribes.
void resize_rocks(World& world, std::span<const EntityId> rocks);

/// Grows rocks by `factor`, except those whose overlap (`squeezed`, from largest_overlaps) exceeds
/// `limit` times their bounding radius. Returns true when all rocks have their full size.
bool grow_rocks(World& world, std::span<const EntityId> rocks, std::span<const double> squeezed,
                double factor, double limit);

} // namespace bris

#pragma once

#include "engine/math.hpp"
#include "engine/simulation.hpp"
#include "engine/world.hpp"

#include <cstdint>
#include <vector>

namespace bris::peers {

/// A box of six planes with a corner at the origin; those opposite to it can move. They are the
/// last three bodies.
void add_moving_box(World& world, const Vec3& box, std::uint32_t material);

/// m, where they are.
Vec3 sides_of(const World& world);
/// Pa, of the grains on them in the last step.
Vec3 pressure_on(const World& world);
/// m/s, outwards.
void move_walls(Simulation& simulation, const Vec3& velocity);

/// The path that every code takes in `steps` steps: nothing moves for a tenth of them, then the box
/// becomes lower by `strain` and half as much wider each way at a steady speed (to first order its
/// volume stays), then a tenth of rest. Returns the pressures at the ends of its parts.
inline constexpr unsigned path_parts = 20;
std::vector<Vec3> compress(Simulation& simulation, double strain, std::uint64_t steps);

} // namespace bris::peers

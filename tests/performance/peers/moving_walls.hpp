#pragma once

#include "engine/math.hpp"
#include "engine/simulation.hpp"
#include "engine/world.hpp"

#include <cstdint>
#include <vector>

namespace bris::peers {

/// Adds a box of six planes with a corner at the origin. The three planes opposite to the origin
/// can move and are the last three bodies.
void add_moving_box(World& world, const Vec3& box, std::uint32_t material);

/// Positions (m) of the moving planes, which are the sides of the box.
Vec3 sides_of(const World& world);
/// Pressures (Pa) of the grains on the moving planes in the last step.
Vec3 pressure_on(const World& world);
/// Sets the outward velocities (m/s) of the moving planes.
void move_walls(Simulation& simulation, const Vec3& velocity);

/// The path that every code takes in `steps` steps: for a tenth of them nothing moves, then the
/// height of the box decreases by `strain` and each width increases by half of it at constant speed
/// (to first order the volume is constant), then for a tenth nothing moves. Returns the pressures
/// (Pa) at the ends of the path's parts.
inline constexpr unsigned path_parts = 20;
std::vector<Vec3> compress(Simulation& simulation, double strain, std::uint64_t steps);

} // namespace bris::peers

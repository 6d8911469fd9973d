#pragma once

#include "components/membrane.hpp"
#include "components/sleeve.hpp"
#include "engine/world.hpp"

namespace bris {

/// Size of a sleeve: levels and columns of nodes, and the prism of `sectors` plane sides around the
/// z axis, with an inscribed circle of `radius` (m), that it has when it is put on. The columns
/// divide the sides into equal parts.
struct SleeveMesh {
    unsigned columns = 24, levels = 9, sectors = 12;
    double radius = 0, height = 0; ///< m
};

/// Adds a sleeve of latex with its body, without stress; `membrane` says at which pressure it is
/// held.
void add_sleeve(World& world, Membrane membrane, Sleeve sleeve, const SleeveMesh& mesh,
                std::uint32_t material);

/// Puts the sleeve of a world on a specimen of another radius and height (m), without stress and at
/// rest.
void put_on(World& world, unsigned sectors, double radius, double height);

/// Volume (m3) inside a sleeve, between its first and its last level.
double sleeve_volume(const World& world);

/// Mean radius (m) of the nodes in each of `bands` parts of the present height.
std::vector<double> sleeve_radii(const World& world, std::size_t bands);

} // namespace bris

#pragma once

#include "components/boundary.hpp"
#include "engine/world.hpp"

#include <span>
#include <vector>

namespace bris {

// Round vessels of plane facets. A circle becomes a regular polygon of the same area, so a vessel
// holds what its round original holds: its corners stand (pi/n)^2/3 of the radius farther out, the
// middles of its sides (pi/n)^2/6 nearer (n = 64: 0.08 % and 0.04 %). Grains are inside; corners
// are at angles 2 pi k / n.

/// A piece of a cone about the z axis, m. Equal radii: a cylinder. Equal heights: a flat ring whose
/// lower radius is the inner one, grains above.
struct Frustum {
    double low_radius = 0, low = 0;
    double high_radius = 0, high = 0;
};

/// Its wall as `sectors` quads (at least 3), normals towards the axis.
std::vector<FacetShape> shell(const Frustum& frustum, unsigned sectors);

/// A round plate at a height, cut into strips, which no sphere is near to more than a few of.
/// Normals up, or down. `sectors` is even and at least 4; its rim is that of a shell of as many.
std::vector<FacetShape> disc(double radius, double height, unsigned sectors, bool upwards = true);

/// Distance of the corners from the axis, in radii of the circle: sqrt(2 pi / (n sin(2 pi / n))).
double corner_radius(unsigned sectors);

void add_facets(World& world, EntityId host, std::span<const FacetShape> shapes);

/// A round silo: a barrel on a cone that ends in an orifice, open at the top.
struct Silo {
    double radius = 0.1, orifice_radius = 0.03; ///< m
    double lip = 0, barrel = 0.07,
           top = 0.37; ///< m, heights of the orifice, of the barrel's foot and its rim
    unsigned sectors = 64;
};

/// The bodies of a silo: the wall, and a plate that closes the orifice until it is taken away.
struct SiloBodies {
    EntityId wall, plate;
};
SiloBodies add_silo(World& world, const Silo& silo, std::uint32_t material);

/// Moves a fixed body to where it touches nothing, `away` (m) from where it is. The lists are made
/// anew.
void take_away(World& world, EntityId body, const Vec3& away);

/// A closed drum about the y axis, its middle in the origin; the end discs are planes. Turning, its
/// shape stays and its surface moves: set the Spin of the body returned. A side of the polygon is
/// not quite along that motion: at its ends the surface seems to move through itself at pi/n of its
/// speed, which only dashpots notice.
struct Drum {
    double radius = 0.1, depth = 0.06; ///< m
    unsigned sectors = 128;
};
EntityId add_drum(World& world, const Drum& drum, std::uint32_t material);

} // namespace bris

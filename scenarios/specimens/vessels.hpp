#pragma once

#include "components/boundary.hpp"
#include "engine/world.hpp"

#include <span>
#include <vector>

namespace bris {

// Round vessels made of plane facets. A circle becomes a regular polygon of the same area, so that
// a vessel has the volume of its round original: the corners lie (pi/n)^2/3 of the radius farther
// out, the middles of the sides (pi/n)^2/6 of it farther in (n = 64: 0.08 % and 0.04 %). Grains are
// inside; the corners are at the angles 2 pi k / n.

/// A frustum of a cone about the z axis, m. Equal radii: a cylinder. Equal heights: a flat ring
/// with low_radius as its inner radius and the grains above.
struct Frustum {
    double low_radius = 0, low = 0;
    double high_radius = 0, high = 0;
};

/// Wall of a frustum as `sectors` quadrilaterals with normals towards the axis. Throws InputError
/// for fewer than 3 sectors.
std::vector<FacetShape> shell(const Frustum& frustum, unsigned sectors);

/// Round plate at a height, divided into strips, so that a sphere is close to a few of them only.
/// The normals point upwards or downwards. The rim is that of a shell with the same number of
/// sectors. Throws InputError unless `sectors` is even and at least 4.
std::vector<FacetShape> disc(double radius, double height, unsigned sectors, bool upwards = true);

/// Distance of the corners from the axis relative to the radius of the circle:
/// sqrt(2 pi / (n sin(2 pi / n))).
double corner_radius(unsigned sectors);

/// Adds several facets to one host body.
void add_facets(World& world, EntityId host, std::span<const FacetShape> shapes);

/// A round silo: a cylinder on a cone that ends in an orifice, open at the top.
struct Silo {
    double radius = 0.1, orifice_radius = 0.03; ///< m
    /// Heights of the orifice, of the lower and of the upper end of the cylinder, m.
    double lip = 0, barrel = 0.07, top = 0.37;
    unsigned sectors = 64;
};

/// Bodies of a silo: the wall, and a plate that closes the orifice until take_away removes it.
struct SiloBodies {
    EntityId wall, plate;
};
SiloBodies add_silo(World& world, const Silo& silo, std::uint32_t material);

/// Moves a fixed body by `away` (m) to a position where it touches nothing, and has the pair lists
/// rebuilt. Throws InputError if the body is not fixed.
void take_away(World& world, EntityId body, const Vec3& away);

/// A closed drum about the y axis, centred at the origin; its ends are planes.
struct Drum {
    double radius = 0.1, depth = 0.06; ///< m
    unsigned sectors = 128;
};
/// Adds a drum and returns its body. To rotate it, set the angular velocity of this body
/// (set_angular_velocity): the facets stay where they are and only their surface velocity changes.
/// The sides of the polygon are not exactly parallel to that velocity: at the ends of a side the
/// surface has a normal velocity of pi/n of its speed, which affects dashpots only.
EntityId add_drum(World& world, const Drum& drum, std::uint32_t material);

} // namespace bris

#pragma once

#include "engine/math.hpp"
#include "scenarios/rocks/mass_properties.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace bris {

/// A closed surface of triangles, corners counter-clockwise seen from outside.
struct Polyhedron {
    std::vector<Vec3> vertices; // m
    std::vector<std::array<std::size_t, 3>> triangles;
    int faces = 0; ///< flat faces before they were cut into triangles
};

struct RockSettings {
    double flat_elongated = 1.8; ///< longest / shortest dimension, 1 to 4
    double flatness =
        0.5;        ///< 0 long (a rod) to 1 flat (a plate): intermediate = shortest * F&E^flatness
    int faces = 20; ///< planes that cut the rock, 6 to 60; fewer are more angular
    double roughness = 0.25; ///< 0 to 0.5: scatter of the planes' distances from the centre
};

/// A random convex rock of sieve size 1 m: the intersection of half-spaces with scattered
/// directions and distances, stretched along three axes until its measured dimensions
/// (dimensions.hpp) have the wanted ratio to 0.1 %. A pure function of (settings, seed, index). A
/// plane may be cut away entirely, so `Polyhedron::faces` can be a little less than asked. Throws
/// InputError outside the ranges above.
Polyhedron make_rock(const RockSettings& settings, std::uint64_t seed, std::uint64_t index);

/// Cube of the given side about the origin.
Polyhedron make_cube(double side);

/// Exact volume, centre and inertia: sums over the tetrahedra from the origin to each triangle.
/// Error of rounding only.
MassProperties mass_properties(const Polyhedron& polyhedron);

/// Vertices as balls of radius 0, for the measures that only see the hull.
std::vector<Ball> vertex_balls(const Polyhedron& polyhedron);

/// Every vertex multiplied by `factor`.
void scale(Polyhedron& polyhedron, const Vec3& factor);

} // namespace bris

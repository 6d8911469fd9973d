#pragma once

#include "engine/math.hpp"
#include "scenarios/rocks/mass_properties.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace bris {

/// A closed surface of triangles whose vertices are counter-clockwise seen from outside.
struct Polyhedron {
    std::vector<Vec3> vertices; ///< m
    std::vector<std::array<std::size_t, 3>> triangles;
    int faces = 0; ///< number of flat faces before they were divided into triangles
};

/// Settings of a random rock.
struct RockSettings {
    double flat_elongated = 1.8; ///< longest / shortest dimension, 1 to 4
    /// From 0 (elongated, a rod) to 1 (flat, a plate): the intermediate dimension is the shortest
    /// times flat_elongated^flatness.
    double flatness = 0.5;
    int faces = 20;          ///< number of planes that cut the rock, 6 to 60; fewer: more angular
    double roughness = 0.25; ///< scatter of the distances of the planes from the centre, 0 to 0.5
};

/// Makes a random convex rock of sieve size 1 m: the intersection of half-spaces with random
/// directions and distances, stretched along three axes until its measured dimensions
/// (dimensions.hpp) have the wanted ratio to 0.1 %. A pure function of (settings, seed, index). A
/// plane may be cut away entirely, so `Polyhedron::faces` can be slightly less than requested.
/// Throws InputError outside the ranges above.
Polyhedron make_rock(const RockSettings& settings, std::uint64_t seed, std::uint64_t index);

/// Makes a cube of the given side (m) about the origin.
Polyhedron make_cube(double side);

/// Computes exact volume, centre of mass and inertia as sums over the tetrahedra from one point to
/// each triangle. The only error is round-off.
MassProperties mass_properties(const Polyhedron& polyhedron);

/// Sum of the areas of the triangles, m2.
double surface_area(const Polyhedron& polyhedron);

/// Vertices as spheres of radius 0, for functions that only use the convex hull.
std::vector<Ball> vertex_balls(const Polyhedron& polyhedron);

/// Multiplies every vertex by `factor`, component by component.
void scale(Polyhedron& polyhedron, const Vec3& factor);

} // namespace bris

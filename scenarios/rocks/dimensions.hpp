#pragma once

#include "components/clump.hpp"

#include <span>

namespace bris {

/// Width of the convex hull of the spheres along a unit vector, m.
double width(std::span<const Ball> balls, const Vec3& direction);

/// Caliper dimensions of a shape, m. The shortest is the least width over all directions, the
/// intermediate is the least width perpendicular to it, and the longest is the width perpendicular
/// to both. For a box they are its edges.
struct Dimensions {
    double longest, intermediate, shortest;
    Mat3 axes; ///< columns: directions of longest, intermediate, shortest; right-handed
    /// Flat-and-elongated ratio: longest over shortest dimension.
    double flat_elongated() const { return longest / shortest; }
};

/// Computes the caliper dimensions of the convex hull of the spheres; spheres of radius 0 (the
/// vertices of a polyhedron) are allowed. Searches a lattice of 4,000 directions with local
/// refinement. The error is below 1e-4 of the size.
Dimensions compute_dimensions(std::span<const Ball> balls);

} // namespace bris

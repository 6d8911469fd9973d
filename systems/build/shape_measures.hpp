#pragma once

#include "components/clump.hpp"
#include "systems/build/rock.hpp"

#include <array>
#include <span>
#include <vector>

namespace bris {

/// Caliper dimensions, m: shortest = least width over all directions, intermediate = least width at
/// right angles to it, longest = width at right angles to both. A box gives its edges.
struct Dimensions {
    double longest, intermediate, shortest;
    Mat3 axes; ///< columns: directions of longest, intermediate, shortest; right-handed
    double flat_elongated() const { return longest / shortest; }
};

/// Dimensions of the hull of the balls (radius 0 allowed: vertices). Search over a lattice of 4,000
/// directions with local refinement; error below 1e-4 of the size.
Dimensions measure_dimensions(std::span<const Ball> balls);

/// Outline of a solid along a direction: a closed polygon, and its area.
using Outline = std::vector<std::array<double, 2>>;

/// Angularity of an outline after Rao, Tutumluer and Kim (2002), degrees: the outline becomes a
/// polygon of 24 equal lengths of perimeter; each of the 24 changes of the angle at a corner from one
/// corner to the next counts with the lower bound of its 10° class. The mean over 8 starting points
/// removes the dependence on where one starts. 0 for a circle; 400 to 600 for crushed rock.
double outline_angularity(const Outline& outline);

/// Area-weighted mean of the outline angularity over the three views along `axes`, degrees. Of a
/// polyhedron: the outline of its hull. The dents between the balls of a clump count, as they would
/// in a photograph; `hull_angularity` leaves them out and shows how round the corners have become.
double angularity(const Polyhedron& polyhedron, const Mat3& axes);
double angularity(std::span<const Ball> balls, const Mat3& axes);
double hull_angularity(std::span<const Ball> balls, const Mat3& axes);

/// Distance to a triangulated surface, m; negative inside. Inside means a winding number above 1/2,
/// so the body need not be convex. Cost: all triangles.
double signed_distance(const Polyhedron& polyhedron, const Vec3& point);

struct SurfacePoint {
    Vec3 position, normal; ///< m; unit, outwards
};

/// About `count` points spread evenly by area over the triangles. The same points every time.
std::vector<SurfacePoint> surface_points(const Polyhedron& polyhedron, std::size_t count);

/// Mean (by area) and greatest distance, m.
struct SurfaceDistance {
    double mean = 0, max = 0;
};

/// From points of the polyhedron's surface, its vertices included in the maximum, to the union's.
SurfaceDistance distance_to_union(const Polyhedron& polyhedron, std::span<const Ball> balls);
/// From points of the union's surface to the polyhedron's.
SurfaceDistance distance_to_polyhedron(const Polyhedron& polyhedron, std::span<const Ball> balls);

} // namespace bris

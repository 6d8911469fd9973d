#pragma once

#include "components/clump.hpp"
#include "scenarios/rocks/rock.hpp"

#include <span>
#include <vector>

namespace bris {

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

#pragma once

#include "components/clump.hpp"
#include "scenarios/rocks/rock.hpp"

#include <span>
#include <vector>

namespace bris {

/// Computes the distance from a point to a triangulated surface, m; negative inside. A point is
/// inside if the winding number is above 1/2, so the solid need not be convex. The cost is
/// proportional to the number of triangles.
double signed_distance(const Polyhedron& polyhedron, const Vec3& point);

/// A point on a surface.
struct SurfacePoint {
    Vec3 position, normal; ///< m; unit, outwards
};

/// About `count` points spread evenly over the area of the triangles. Deterministic.
std::vector<SurfacePoint> surface_points(const Polyhedron& polyhedron, std::size_t count);

/// Mean (over the area) and greatest distance, m.
struct SurfaceDistance {
    double mean = 0, max = 0;
};

/// Distance from the surface of the polyhedron to that of the union of the spheres. The vertices
/// are included in the maximum.
SurfaceDistance distance_to_union(const Polyhedron& polyhedron, std::span<const Ball> balls);
/// Distance from the surface of the union of the spheres to that of the polyhedron.
SurfaceDistance distance_to_polyhedron(const Polyhedron& polyhedron, std::span<const Ball> balls);

} // namespace bris

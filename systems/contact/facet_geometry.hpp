#pragma once

#include "components/boundary.hpp"

#include <cmath>

namespace bris::detail {

/// The part of a facet that is nearest to a point.
enum class Feature { none, vertex, edge, face };

/// Nearest point of a facet. Members have no default values, because the kernel keeps an array of
/// them and fills only those that it needs.
struct Nearest {
    Feature feature;
    Vec3 point;
    Vec3 normal;     ///< unit vector from the facet to the sphere's centre
    double distance; ///< m
};

inline Nearest nothing_near() { return {Feature::none, Vec3::Zero(), Vec3::Zero(), 0}; }

/// Finds the point of a convex facet that is nearest to a sphere's centre.
inline Nearest nearest_on_mesh_facet(const FacetRow& facet, const Vec3& centre) {
    const double height = (centre - facet.corners[0]).dot(facet.normal);
    const Vec3 foot = centre - height * facet.normal;
    bool inside = true;
    Nearest best = nothing_near();
    double best_squared = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const Vec3& from = facet.corners[k];
        const Vec3 edge = facet.corners[(k + 1) % 4] - from;
        const double length2 = edge.squaredNorm();
        if (length2 == 0) continue; // a triangle repeats a corner
        if (facet.normal.cross(edge).dot(foot - from) >= 0) continue;
        inside = false;
        const double along = (foot - from).dot(edge) / length2;
        const Vec3 point = from + std::min(1.0, std::max(0.0, along)) * edge;
        const double squared = (centre - point).squaredNorm();
        if (best.feature == Feature::none || squared < best_squared) {
            best.feature = along > 0 && along < 1 ? Feature::edge : Feature::vertex;
            best.point = point;
            best_squared = squared;
        }
    }
    if (inside) {
        const double side = height < 0 ? -1 : 1;
        return {Feature::face, foot, side * facet.normal, side * height};
    }
    best.distance = std::sqrt(best_squared);
    best.normal = (centre - best.point) / best.distance;
    return best;
}

} // namespace bris::detail

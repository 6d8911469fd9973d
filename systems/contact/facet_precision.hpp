#pragma once

#include "components/boundary.hpp"

#include <algorithm>
#include <cmath>

namespace bris::detail {

/// What a point of a facet's plane, `distance` (m) away from the facet, may be off (m) because the
/// corners were rounded to single precision, as in every binary STL file, and once more when they
/// were scaled. Coordinates are those of the input: from the origin of the world, and of a free
/// host from its position.
inline double rounding_of(const FacetRow& facet, double distance) {
    constexpr double rounded = 0x1p-23; // twice half a unit in the last place
    const Vec3 origin = facet.free_host == no_row ? Vec3(Vec3::Zero()) : facet.motion.centre;
    const auto& c = facet.corners;
    double extent = 0, longest = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        extent = std::max(extent, (c[k] - origin).squaredNorm());
        longest = std::max(longest, (c[(k + 1) % 4] - c[k]).squaredNorm());
    }
    const double altitude = (c[2] - c[0]).cross(c[3] - c[1]).norm() / std::sqrt(longest);
    return 2 * rounded * std::sqrt(extent) * (1 + distance / altitude);
}

/// Whether something `apart` (m) counts as together: within the precision of computation, or of the
/// input. `rounding()` (m) is called only where it decides. Nothing farther apart than 1e-3 of the
/// sphere's radius counts, whatever the precision: contacts are as deep as that.
template <class Rounding>
bool is_together(double apart, double radius, Rounding&& rounding) {
    if (apart <= 1e-9 * radius) return true;
    return apart <= 1e-3 * radius && apart <= rounding();
}

/// Whether the surfaces of two hosts have the same velocity everywhere, and no force moves them.
inline bool move_as_one(const FacetRow& a, const FacetRow& b) {
    if (a.free_host != no_row || b.free_host != no_row) return false;
    const SurfaceMotion &m = a.motion, &n = b.motion;
    if (m.angular_velocity != n.angular_velocity) return false;
    if (m.velocity == n.velocity && m.angular_velocity == Vec3::Zero()) return true;
    const Vec3 turned = m.angular_velocity.cross(m.centre - n.centre);
    return (m.velocity - n.velocity - turned).norm() <=
           1e-12 * (m.velocity.norm() + n.velocity.norm() + turned.norm());
}

} // namespace bris::detail

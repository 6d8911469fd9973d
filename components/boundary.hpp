#pragma once

#include "engine/component.hpp"
#include "engine/entity.hpp"
#include "engine/math.hpp"

#include <array>

namespace bris {

/// The body that a facet or plane belongs to.
struct HostId : State<EntityId> {
    static constexpr auto name = "host", unit = "";
};
/// Current row of that body.
struct HostRow : Derived<Row> {
    static constexpr auto name = "host_row", unit = "";
};

/// Motion of a host's surface as a rigid body about the host's position. The geometry of a driven
/// host that rotates stays where it is, as that of a drum does: rotation changes only the surface
/// velocity. The facets of a free host turn with it.
struct SurfaceMotion {
    Vec3 velocity, angular_velocity, centre;
    Vec3 at(const Vec3& point) const { return velocity + angular_velocity.cross(point - centre); }
};

/// An infinite plane. The normal points to the side of the grains.
struct PlaneShape {
    Vec3 point, normal;
};
struct PlaneId : State<EntityId> {
    static constexpr auto name = "id", unit = "";
    static constexpr bool is_key = true;
};
/// Plane relative to the host's position.
struct LocalPlane : State<PlaneShape> {
    static constexpr auto name = "plane", unit = "m";
};
struct PlaneRow {
    Vec3 point, normal;
    SurfaceMotion motion;
};
struct PlanePosition : Derived<PlaneRow> {
    static constexpr auto name = "position", unit = "m";
};

/// A convex plane facet with four corners, counter-clockwise as seen from the grains. A triangle
/// repeats its last corner.
struct FacetShape {
    std::array<Vec3, 4> corners;
};
struct FacetId : State<EntityId> {
    static constexpr auto name = "id", unit = "";
    static constexpr bool is_key = true;
};
/// Facet relative to the host's position.
struct LocalFacet : State<FacetShape> {
    static constexpr auto name = "facet", unit = "m";
};
struct FacetRow {
    std::array<Vec3, 4> corners;
    Vec3 normal;
    SurfaceMotion motion;
    Row free_host; ///< row of the host if forces move it; no_row if it is driven
};
struct FacetPosition : Derived<FacetRow> {
    static constexpr auto name = "position", unit = "m";
};

/// Corners and normal of a facet in the world. The host has the given pose.
inline FacetRow placed(const FacetShape& shape, const Vec3& position, const Quat& orientation) {
    FacetRow row{};
    for (std::size_t k = 0; k < 4; ++k) row.corners[k] = position + orientation * shape.corners[k];
    const auto& c = shape.corners;
    row.normal = orientation * (c[1] - c[0]).cross(c[2] - c[0]).normalized();
    row.free_host = no_row;
    return row;
}

} // namespace bris

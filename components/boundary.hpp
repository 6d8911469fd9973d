#pragma once

#include "engine/component.hpp"
#include "engine/entity.hpp"
#include "engine/math.hpp"

#include <array>

namespace bris {

/// The body that a facet or plane belongs to, and where it stands now.
struct HostId : State<EntityId> {
    static constexpr auto name = "host", unit = "";
};
struct HostRow : Derived<Row> {
    static constexpr auto name = "host_row", unit = "";
};

/// How the surface of a host moves: as a rigid body about its position. A host that turns keeps its
/// shape where it is, as a drum does: only the velocity of its surface turns.
struct SurfaceMotion {
    Vec3 velocity, angular_velocity, centre;
    Vec3 at(const Vec3& point) const { return velocity + angular_velocity.cross(point - centre); }
};

/// An infinite plane: grains are on the side that the normal points to.
struct PlaneShape {
    Vec3 point, normal;
};
struct PlaneId : State<EntityId> {
    static constexpr auto name = "id", unit = "";
    static constexpr bool is_key = true;
};
struct LocalPlane : State<PlaneShape> {
    static constexpr auto name = "plane", unit = "m";
}; // relative to the host's position
struct PlaneRow {
    Vec3 point, normal;
    SurfaceMotion motion;
};
struct PlanePosition : Derived<PlaneRow> {
    static constexpr auto name = "position", unit = "m";
};

/// A convex plane facet of four corners, counter-clockwise seen from the grains; a triangle repeats
/// its last corner.
struct FacetShape {
    std::array<Vec3, 4> corners;
};
struct FacetId : State<EntityId> {
    static constexpr auto name = "id", unit = "";
    static constexpr bool is_key = true;
};
struct LocalFacet : State<FacetShape> {
    static constexpr auto name = "facet", unit = "m";
}; // relative to the host's position
struct FacetRow {
    std::array<Vec3, 4> corners;
    Vec3 normal;
    SurfaceMotion motion;
};
struct FacetPosition : Derived<FacetRow> {
    static constexpr auto name = "position", unit = "m";
};

} // namespace bris

#pragma once

#include "engine/component.hpp"
#include "engine/entity.hpp"
#include "engine/math.hpp"

#include <array>

namespace bris {

/// The body that a facet or plane belongs to, and where it stands now.
struct HostId  : State<EntityId> { static constexpr auto name = "host", unit = ""; };
struct HostRow : Derived<Row>    { static constexpr auto name = "host_row", unit = ""; };

/// An infinite plane: grains are on the side that the normal points to.
struct PlaneShape { Vec3 point, normal; };
struct PlaneId     : State<EntityId>   { static constexpr auto name = "id", unit = ""; static constexpr bool is_key = true; };
struct LocalPlane  : State<PlaneShape> { static constexpr auto name = "plane", unit = "m"; };         // relative to the host's position
struct PlanePlaceRow { Vec3 point, normal, velocity; };
struct PlanePlace  : Derived<PlanePlaceRow> { static constexpr auto name = "place", unit = "m"; };

/// A convex plane facet of four corners, counter-clockwise seen from the grains; a triangle repeats
/// its last corner.
struct FacetShape { std::array<Vec3, 4> corners; };
struct FacetId     : State<EntityId>   { static constexpr auto name = "id", unit = ""; static constexpr bool is_key = true; };
struct LocalFacet  : State<FacetShape> { static constexpr auto name = "facet", unit = "m"; };      // relative to the host's position
struct FacetPlaceRow { std::array<Vec3, 4> corners; Vec3 normal, velocity; };
struct FacetPlace  : Derived<FacetPlaceRow> { static constexpr auto name = "place", unit = "m"; };

} // namespace bris

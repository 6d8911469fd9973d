#pragma once

#include "components/clump.hpp"
#include "engine/component.hpp"
#include "engine/entity.hpp"

namespace bris {

struct SphereId : State<EntityId> {
    static constexpr auto name = "id", unit = "";
    static constexpr bool is_key = true;
};
struct ParentId : State<EntityId> {
    static constexpr auto name = "parent", unit = "";
};
/// x, y, z and radius in the axes of the body.
struct LocalBall : State<Ball> {
    static constexpr auto name = "ball", unit = "m";
};
/// Slot in Listed, or no_row.
struct ListedSlot : Derived<Row> {
    static constexpr auto name = "slot", unit = "";
};

/// What every near pair reads of a sphere, in half a cache line.
struct alignas(32) SphereRow {
    double x, y, z, radius;
};

/// All spheres at the time when the lists are made, their radii enlarged by the skins of their
/// bodies.
struct EnlargedSphere : Derived<SphereRow> {
    static constexpr auto name = "enlarged_sphere", unit = "m";
};
struct ListedPosition : Derived<SphereRow> {
    static constexpr auto name = "position", unit = "m";
};
struct ListedBody : Derived<Row> {
    static constexpr auto name = "body", unit = "";
};
struct ListedBall : Derived<Ball> {
    static constexpr auto name = "ball", unit = "m";
};

} // namespace bris

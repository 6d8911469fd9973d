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
struct LocalBall : State<Ball> {
    static constexpr auto name = "ball", unit = "m";
}; // x y z r in the body's axes
struct ListedSlot : Derived<Row> {
    static constexpr auto name = "slot", unit = "";
}; // in Listed, or no_row

/// What every near pair reads of a sphere: half a cache line.
struct alignas(32) SphereRow {
    double x, y, z, radius;
};

struct SpherePosition : Derived<SphereRow> {
    static constexpr auto name = "position", unit = "m";
}; // of all, when lists are made
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

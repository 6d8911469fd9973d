#pragma once

#include "components/clump.hpp"
#include "engine/component.hpp"
#include "engine/entity.hpp"

namespace bris {

struct SphereId   : State<EntityId> { static constexpr auto name = "id", unit = ""; static constexpr bool is_key = true; };
struct ParentId   : State<EntityId> { static constexpr auto name = "parent", unit = ""; };
struct LocalBall  : State<Ball>     { static constexpr auto name = "ball", unit = "m"; };       // x y z r in the body's axes
struct ListedSlot : Derived<Row>    { static constexpr auto name = "slot", unit = ""; };        // in Listed, or no_row

/// What a contact reads of a sphere in one cache line: centre, radius, velocity of the centre,
/// inverse inertial mass of the body (0 if driven).
struct alignas(64) PlaceRow { double x, y, z, radius, vx, vy, vz, inverse_mass; };
/// Spin of the body.
struct alignas(32) TurnRow { double x, y, z, unused; };

struct Place      : Derived<PlaceRow> { static constexpr auto name = "place", unit = "m, m/s, 1/kg"; };
struct Turn       : Derived<TurnRow>  { static constexpr auto name = "turn", unit = "rad/s"; };
struct ListedBall : Derived<Ball>     { static constexpr auto name = "ball", unit = "m"; };

} // namespace bris

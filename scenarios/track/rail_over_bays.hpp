#pragma once

#include "engine/world.hpp"
#include "scenarios/ballast_box/train.hpp"

namespace bris {

/// Adds ties on springs before and behind a track of `bays` bays, of whose first one the world
/// consists, so that a train comes and goes on a rail that does not end at the ballast. The springs
/// are as stiff as pads and `rails.tie_support` leave for the bed, and only push. Returns the id of
/// the first of these ties.
EntityId add_ties_on_springs(World& world, const RailOnTies& rails, unsigned bays);

/// Lays a rail on all ties of a track whose bays and ties on springs are there, as high as they
/// are, so that it pushes nowhere. `first`: id of the first tie on springs.
void lay_rail(World& world, const RailOnTies& rails, EntityId first);

/// Lifts the ties on ballast by `gap` (m, > 0) and hangs them on the rail, at rest: it sags under
/// their weights, which the ties on springs carry. The ballast rebounds for some time.
void hang_ties(World& world, double gap);

/// A train begins to pass: its first axle is above the first tie at the present time.
void begin_train(World& world, const Train& train, double speed);

/// s, until the last axle of a train is above the last tie.
double time_on_rail(const World& world, const Train& train, double speed);

} // namespace bris

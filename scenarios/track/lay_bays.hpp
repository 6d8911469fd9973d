#pragma once

#include "engine/world.hpp"

namespace bris {

/// The bays of a track whose grains a rank makes: from `first` to before `last`.
struct OwnBays {
    unsigned first, last;
};

/// Lays copies of a seated bay (model `bay` of BallastBox) side by side along x, so that the
/// world is a track of `bays` bays. Every second one is the mirror image of the others: the
/// frictionless sides of the bay are mirrors, and where one was, each rock now meets its own image
/// with the force with which it met the side. So the track is as much at rest as the bay was. Its
/// two ends keep the sides.
///
/// Its rocks are the mirror images of their shapes, whose numbers (ShapeOf) they keep.
///
/// Bodies, spheres and facets of bay k have the ids of the first bay plus k times as many as that
/// has. Sensor rocks record in the middle bay only. Bodies without spheres whose numbers are from
/// `once` on are not copied, nor are the walls; the plates that compacted the lifts are removed.
/// Grains of bays that are not `own` are left out. Throws InputError if the world is none of such a
/// bay. To be followed by Simulation::prepare.
void lay_bays(World& world, unsigned bays, OwnBays own, EntityId once);

} // namespace bris

#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/rows.hpp"

namespace bris {

using WatchedBodies =
    Rows<Bodies, const BodyId, const MotionOf, const DisplacementBound, const Position,
         const Velocity, const AngularVelocity, const BoundingRadius>;

/// Checks every step for: positions or angular velocities that are not finite; bodies faster than
/// the limit; free bodies outside the box of the scene; and displacements that could carry one
/// surface through another undetected. The limit of displacement in a step is Limits::overlap times
/// the body's own bounding radius for a free body, and times that of the smallest free body for a
/// driven one. Records the first offender in Health; the simulation then stops with step, time and
/// a checkpoint.
void guard_motion(WatchedBodies bodies, const Limits& limits, const Clock& clock, Health& health);

/// Reports overlaps beyond the limit that the contact kernels found. One system per kind of pair.
template <class Pairs>
void guard_overlap(Rows<typename Pairs::Near, const NearPair, const PairForce> near,
                   Rows<Pairs, const PairKey> pairs, const NearIndex<Pairs>& index,
                   const Limits& limits, Health& health) {
    for (const Row row : index.beyond_limit) {
        if (row == no_row || health.bad) continue;
        const PairNames& who =
            pairs.template column<PairKey>()[near.template column<NearPair>()[row].pair];
        health.bad = true;
        health.what = "overlap of bodies " + std::to_string(who.owner) + " and " +
                      std::to_string(who.partner) + ": expected less than " +
                      std::to_string(limits.overlap) + " radii, found " +
                      std::to_string(near.template column<PairForce>()[row].overlap) +
                      " m; try a smaller step or a gentler start";
    }
}

} // namespace bris

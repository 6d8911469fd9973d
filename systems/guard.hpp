#pragma once

#include "components/body.hpp"
#include "components/census.hpp"
#include "components/force_sums.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/rows.hpp"

#include <string>
#include <type_traits>

namespace bris {

using WatchedBodies =
    Rows<Bodies, const BodyId, const MotionOf, const DisplacementBound, const Position,
         const Velocity, const AngularVelocity, const BoundingRadius>;

/// Checks every step for: positions or angular velocities that are not finite; bodies faster than
/// the limit; free bodies outside the box of the scene; and displacements that could carry one
/// surface through another undetected. The limit of displacement in a step is Limits::overlap times
/// the body's own bounding radius for a free body, and times that of the smallest free body for a
/// driven one. Raises the alarm; guard_motion then finds the body.
void watch_motion(WatchedBodies bodies, const Limits& limits, const Clock& clock,
                  const Census& census, Alarm& alarm);

/// Records in Health the first body that watch_motion has found; the simulation then stops with
/// step, time and a checkpoint. Watches the boundaries once more, because servos have moved them.
void guard_motion(WatchedBodies bodies, const Limits& limits, const Clock& clock,
                  const Census& census, Alarm& alarm, Health& health);

/// The message on two bodies that overlap too deeply or whose contact force cannot be added: mean
/// `radius` in m, `limit` of the overlap as a fraction of the radius, `largest_force` in N.
std::string contact_message(const PairNames& who, const ForceRow& contact, double radius,
                            double limit, double largest_force);

/// Reports contacts beyond the limits of overlap or force that the contact kernels found. One
/// system per kind of pair.
template <class Pairs>
void guard_contacts(Rows<typename Pairs::Near, const NearPair, const PairForce> near,
                    Rows<Pairs, const PairKey, const PairRows> pairs,
                    Rows<Spheres, const LocalBall> spheres, const NearIndex<Pairs>& index,
                    const Limits& limits, const ForceGrid& grid, Health& health) {
    const Ball* ball = spheres.template column<LocalBall>();
    for (const Row row : index.beyond_limit) {
        if (row == no_row || health.bad) continue;
        const Row pair = near.template column<NearPair>()[row].pair;
        const PairNames& who = pairs.template column<PairKey>()[pair];
        const PairRowNumbers& rows = pairs.template column<PairRows>()[pair];
        double radius = ball[rows.sphere].radius; // of the sphere alone at a boundary
        if constexpr (std::is_same_v<Pairs, SpherePairs>)
            radius = 0.5 * (radius + ball[rows.other].radius);
        health.bad = true;
        health.what =
            contact_message(who, near.template column<PairForce>()[row], radius,
                            limits.overlap_of_contacts(), ForceGrid::largest * grid.force);
    }
}

} // namespace bris

#pragma once

#include "components/body.hpp"
#include "components/census.hpp"
#include "components/force_sums.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/lane_math.hpp"
#include "engine/rows.hpp"

#include <limits>
#include <string>
#include <type_traits>

namespace bris {

/// The limits of the motion of a body in a step.
class MotionLimits {
public:
    MotionLimits(const Limits& limits, const Clock& clock, const Census& census)
        : limits_(limits), smallest_free_radius_(census.smallest_free_radius), dt_(clock.dt) {}
    /// Mask of the bodies within their limits, from position (m), velocity (m/s), angular velocity
    /// (rad/s), bound on the displacement (m) and bounding radius (m).
    LaneMask allow(const Vec3Lanes& x, const Vec3Lanes& v, const Vec3Lanes& w,
                   const Lane& displacement, const Lane& radius, const LaneMask& free) const {
        constexpr double infinite = std::numeric_limits<double>::infinity();
        const LaneMask inside = at_least(x, limits_.low) & at_least(Vec3Lanes{} - x, -limits_.high);
        const Lane squared = dot(v, v),
                   most = limits_.overlap * (free ? radius : lanes(smallest_free_radius_));
        const LaneMask finite = (displacement < infinite) & (dot(w, w) < infinite),
                       slow = squared <= limits_.speed * limits_.speed,
                       near = (dt_ * dt_) * squared <= most * most;
        return finite & slow & near & (~free | inside);
    }

private:
    static LaneMask at_least(const Vec3Lanes& a, const Vec3& low) {
        return (a.x >= low.x()) & (a.y >= low.y()) & (a.z >= low.z());
    }
    const Limits& limits_;
    double smallest_free_radius_, dt_;
};

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

/// Records in Health the overloaded body, or the first one that watch_motion has found; the
/// simulation then stops with step, time and a checkpoint. Watches the boundaries once more,
/// because servos have moved them.
void guard_motion(WatchedBodies bodies, const Limits& limits, const Clock& clock,
                  const Census& census, const ForceGrid& grid, Overload& overload, Alarm& alarm,
                  Health& health);

/// The message on two bodies that overlap too deeply or whose contact force cannot be added: mean
/// `radius` in m, `limit` of the overlap as a fraction of the radius, `arm` in m from the contact
/// to the centre of a boundary (0 for two spheres).
std::string contact_message(const PairNames& who, const ForceRow& contact, double radius,
                            double limit, double arm, const ForceGrid& grid);

/// Reports contacts beyond the limits of overlap or force that the contact kernels found, and
/// counts those of an overloaded body. One system per kind of pair.
template <class Pairs>
void guard_contacts(Rows<Bodies, const Position> bodies,
                    Rows<typename Pairs::Near, const NearPair, const PairForce> near,
                    Rows<Pairs, const PairKey, const PairRows> pairs,
                    Rows<Spheres, const LocalBall> spheres, const NearIndex<Pairs>& index,
                    const Limits& limits, const ForceGrid& grid, Overload& overload,
                    Health& health) {
    const Ball* ball = spheres.template column<LocalBall>();
    const PairNames* names = pairs.template column<PairKey>();
    const NearEntry* entry = near.template column<NearPair>();
    if (overload.body != nobody)
        index.for_touching([&](Row k) {
            const PairNames& who = names[entry[k].pair];
            if (who.owner == overload.body || who.partner == overload.body) ++overload.contacts;
        });
    for (const Row row : index.beyond_limit) {
        if (row == no_row || health.bad) continue;
        const Row pair = entry[row].pair;
        const PairNames& who = names[pair];
        const PairRowNumbers& rows = pairs.template column<PairRows>()[pair];
        const ForceRow& force = near.template column<PairForce>()[row];
        double radius = ball[rows.sphere].radius, arm = 0; // of the sphere alone at a boundary
        if constexpr (std::is_same_v<Pairs, SpherePairs>)
            radius = 0.5 * (radius + ball[rows.other].radius);
        else
            arm = (Vec3(force.px, force.py, force.pz) -
                   bodies.template column<Position>()[rows.partner_body])
                      .norm();
        health.bad = true;
        health.what = contact_message(who, force, radius, limits.overlap_of_contacts(), arm, grid);
    }
}

} // namespace bris

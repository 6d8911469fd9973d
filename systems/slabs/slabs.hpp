#pragma once

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/census.hpp"
#include "components/force_sums.hpp"
#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "components/platen.hpp"
#include "components/recorder.hpp"
#include "components/settings.hpp"
#include "components/slab.hpp"
#include "components/sleep.hpp"
#include "components/sleeve.hpp"
#include "components/sphere.hpp"
#include "engine/clock.hpp"
#include "engine/health.hpp"
#include "engine/rows.hpp"

#include <vector>

namespace bris {

// A world that is divided among the ranks of a run: each rank computes the bodies of one slab, and
// both sides of a cut compute the contacts across it, from the same numbers. The sums of forces are
// integers, so that the results have the same bits for any number of ranks.

/// Number of slabs into which a world can be divided along its longest side, if each is at least as
/// wide as two of its largest bodies; at least 1. Thinner slabs would hold little but ghosts.
unsigned most_slabs(const World& world);

/// This rank's part of a world that all ranks have, or as far as each has made it (SlabPlan): the
/// bodies of its slab, ghosts, and all boundaries. The slabs have equal work. `SpheresOf` and
/// `OuterSkin` must be up to date (survey). The whole world has no bodies any more, until
/// give_back.
World take_slab(World& whole);

/// Ghosts of all ranks over the bodies with spheres, as all ranks ask; 0 of a whole world.
double share_of_ghosts(const World& world);

/// The rank in whose slab each body of a whole world lies if it is divided now, by row.
std::vector<unsigned> ranks_of_bodies(const World& whole);

/// Makes the whole world of each rank again, of the State of all parts.
void give_back(const World& part, World& whole);

/// The rows of a table that this rank saves of its part: what belongs to its own bodies, and on the
/// first rank what all have.
std::vector<Row> rows_to_save(const World& part, const Table& table);

/// At the end of a step: if the lists of one rank are used up, all ranks make new ones in the next
/// step, since the others would wait for it. If the guard of one rank has found trouble, all stop.
void agree_on_lists(const Slab& slab, ListState& lists, Health& health);

/// Before new candidates: cuts move so that the slabs have equal work, and ranks send each other
/// the bodies that are in or near their slabs.
void exchange_bodies(Slab& slab, World& world);

/// After new candidates: what the step must know of the bodies of all ranks.
void share_census(const Slab& slab, const ListState& lists, const Clock& clock, Census& census);

/// After new candidates: which rows are sent to, and received from, each other rank in each step.
void list_ghosts(Rows<Bodies, const BodyId, const Position, const BoundingRadius, const OuterSkin,
                      const SpheresOf, const Ghost>
                     bodies,
                 const ListState& lists, const Clock& clock, Slab& slab);

/// Clears the sums of ghosts that the grid does not hold, which other ranks have in full.
void forget_sums_of_ghosts(Rows<Bodies, const Ghost> bodies, Rows<ForceSums, ContactSum> sums,
                           const Alarm& alarm);

/// Adds the forces on boundaries over all ranks, where they move a boundary or their work is
/// wanted.
void share_boundary_forces(Rows<Bodies, const MotionOf, const AngularVelocity, const BodyId> bodies,
                           const Census& census, const Slab& slab, BoundarySums& sums);

/// Adds the numbers of grains that touch a platen over all ranks.
void share_platen_contacts(const Slab& slab, Platen& platen);

/// Adds the forces on the elements of a membrane over all ranks.
void share_membrane_forces(const Slab& slab, MembraneSums& sums);
/// Adds the forces on the nodes of a sleeve over all ranks.
void share_sleeve_forces(const Slab& slab, SleeveSums& sums);

/// Gives all ranks the motion that was noted of the bodies with inertial recorders, so that all
/// ranks have the same recordings.
void share_motion(Rows<Bodies, const RecorderOf, const SpheresOf, const Ghost> bodies,
                  const Slab& slab, NotedMotions& motions);

/// Gives ghosts the motion that their own ranks have computed. In scenes of single spheres.
void pass_spheres(Rows<Bodies, const SphereInertia, Position, Velocity, Acceleration,
                       AngularVelocity, StepAngularVelocity>
                      bodies,
                  Slab& slab);
/// The same in scenes of clumps.
void pass_clumps(Rows<Bodies, Position, Velocity, Acceleration, AngularVelocity,
                      StepAngularVelocity, Orientation>
                     bodies,
                 Slab& slab);
/// Gives ghosts the number of steps for which they have been at rest, where bodies sleep.
void pass_resting(Rows<Bodies, Resting> bodies, Slab& slab);

} // namespace bris

#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "components/settings.hpp"
#include "components/slab.hpp"
#include "components/sphere.hpp"
#include "engine/world.hpp"

namespace bris {

/// True in steps that begin with new lists: a body may have moved by half the inner skin since the
/// last prune, or the scene was changed from outside the step.
bool lists_are_due(const World& world);

/// True in steps that begin with an update of the positions and velocities that contacts read: when
/// the lists are new, or velocities were changed from outside the step.
bool positions_are_due(const World& world);
/// Records that contacts read current velocities. It takes the World so that the schedule runs it:
/// only conditions of systems, not systems, read what it writes.
void note_positions(World& world);

/// Finds the candidate pairs within the outer skin and carries their springs over; every few
/// rebuilds it first sorts the rows along a Morton curve. While the candidates are still complete
/// it only chooses the inner skins. Rows of bodies change only here and where ranks exchange
/// bodies.
void rebuild_pairs(World& world);

/// At the end of a step, where a world is divided: notes whether the lists of this rank are used
/// up.
void review_lists(const Slab& slab, World& world);
/// Where those of any rank are: marks all of them as stale, and chooses the outer skins of new
/// candidates, if the candidates of any rank do not suffice for the next step.
void review_candidates(const Slab& slab, World& world);
/// What must be known of a world before it is divided: spheres of bodies and outer skins.
void survey(World& world);

/// Makes the short lists of pairs within the inner skin, the list of their spheres and the index of
/// near pairs. Writes Derived data only, except that it clears the springs of pairs that are apart.
void prune_pairs(World& world);

/// Adds the columns and resources of the lists to a scene that already has all its bodies, spheres
/// and boundaries. The law determines the columns of the pairs; `steps` must be given the same law.
void add_lists(World& world, LawName law, ListSettings settings = {});

/// To be called after bodies were moved, added or changed from outside the step: the lists are made
/// anew at the beginning of the next step.
void invalidate_lists(World& world);

/// To be called after velocities were changed from outside the step: contacts read the new values
/// in the next step.
void show_velocities(World& world);

/// For Simulation::on_restore: discards all data derived from the old state and finds the spheres
/// of each body.
void forget_lists(World& world);

namespace detail {

inline Vec3 centre_of(const SphereRow& p) { return {p.x, p.y, p.z}; }

/// Candidate pair before it becomes a row of its pair table.
struct Candidate {
    PairNames names;
    PairRowNumbers rows;
};

/// First candidate of each body row.
template <class Pairs>
struct Candidates {
    static constexpr auto name = "candidates";
    std::vector<Row> first; ///< bodies + 1
};

// Each finds the candidates of one kind: pairs whose gap is below the sum of their outer skins.
void find_sphere_pairs(World& world);
void find_plane_pairs(World& world);
void find_facet_pairs(World& world);
void find_membrane_pairs(World& world);
void find_triangle_pairs(World& world);

} // namespace detail

} // namespace bris

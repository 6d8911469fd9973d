#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/world.hpp"

namespace bris {

/// True in steps that begin with new lists: some body may have gone half the inner skin since the
/// last prune, or the scene was changed by hand.
bool lists_are_due(const World& world);

/// True in steps that begin with what contacts read placed anew: with new lists, or velocities
/// changed by hand.
bool positions_are_due(const World& world);
void note_positions(ListState& state);

/// Rarely: orders rows along a Morton curve, finds the candidate pairs within the outer skin,
/// carries every spring over. The one place where rows change.
void rebuild_pairs(World& world);

/// Now and then: the short lists, pairs within the inner skin; which spheres are listed; who is
/// near whom. Writes what is Derived, and clears the springs of pairs that are apart.
void prune_pairs(World& world);

/// Adds what the lists need to a scene whose bodies, spheres and boundaries are all there.
/// The law says which columns pairs have; the same law is to be given to `steps`.
void add_lists(World& world, LawName law, ListSettings settings = {});

/// Tells the lists that bodies were moved, added or changed by hand: they are made anew before the
/// next step.
void invalidate_lists(World& world);

/// Tells that velocities were changed by hand: contacts see them in the next step.
void show_velocities(World& world);

/// For Simulation::on_restore: nothing that was derived from the old state is left, and bodies know
/// their spheres.
void forget_lists(World& world);

namespace detail {

inline Vec3 centre_of(const SphereRow& p) { return {p.x, p.y, p.z}; }

/// Candidate of a pair table before it gets its row.
struct Candidate {
    PairNames names;
    PairRowNumbers rows;
};

/// Where the candidates of each body row begin.
template <class Pairs>
struct Candidates {
    static constexpr auto name = "candidates";
    std::vector<Row> first; ///< bodies + 1
};

void find_sphere_pairs(World& world, double skin);
void find_plane_pairs(World& world, double skin);
void find_facet_pairs(World& world, double skin);
void find_membrane_pairs(World& world, double skin);

} // namespace detail

} // namespace bris

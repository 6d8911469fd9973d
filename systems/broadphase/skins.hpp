#pragma once

#include "components/settings.hpp"
#include "engine/world.hpp"

namespace bris::detail {

// Skins of bodies. The faster a body is, the larger are its skins, so that one body that flies
// among others at rest does not make the lists of all of them longer, or serve for fewer steps. The
// skins of bodies of mean speed are adapted to counts of work. Any skins give the same bits. Where
// a world is divided, all ranks choose skins in the same steps, and the same ones.

/// Chooses inner skins for new short lists. Returns whether the candidates, found with the present
/// outer skins, contain all pairs within them.
bool choose_inner_skins(World& world);

/// Chooses the outer skins for new candidates.
void choose_outer_skins(World& world);

/// Chooses the inner and outer skins for new candidates and new short lists. Where a world is
/// divided, the outer ones have been chosen before, because they determine of which bodies a rank
/// has ghosts.
void choose_skins(World& world);

/// Gap (m) beyond the sum of the skins of sphere and facet within which facets must be listed. What
/// holds a sphere goes from one facet to the next beyond touch, so facets must be listed before
/// they come within reach of the law. A pair of spheres or of sphere and plane acts beyond touch
/// only if it has touched, and was on the lists then.
double reach_beyond_skin(const World& world);

/// Largest distance (m) that an element of a rigid membrane, or a node of a sleeve, has moved since
/// the last prune, and since the last rebuild; 0 where there is none.
double membrane_moved_since_prune(const World& world);
double membrane_moved_since_rebuild(const World& world);
/// Notes where they are at a prune and at a rebuild.
void note_membrane_at_prune(World& world);
void note_membrane_at_rebuild(World& world);

} // namespace bris::detail

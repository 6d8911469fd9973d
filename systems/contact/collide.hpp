#pragma once

#include "engine/system.hpp"
#include "components/material.hpp"

namespace bris {

// With `ledger`, the work that friction, dashpots and rolling take is booked for each near pair.

/// Finds which near pairs of spheres touch and writes their forces; moves their springs on. Each
/// pair writes only itself. Reads packed rows.
System collide_spheres(LawName law, bool ledger);

/// The same for spheres against facets: contacts are reduced to one for each feature of a body (face
/// before edge before vertex).
System collide_facets(LawName law, bool ledger);

/// The same for spheres against planes.
System collide_planes(LawName law, bool ledger);

/// The same for spheres against a membrane; never friction.
System collide_membrane(LawName law);

} // namespace bris

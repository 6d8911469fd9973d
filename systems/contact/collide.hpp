#pragma once

#include "components/material.hpp"
#include "engine/system.hpp"

namespace bris {

/// Optional work of the contact systems.
struct StepChoices {
    /// Record the work dissipated by friction, dashpots, rolling and wear for each near pair.
    bool energy_budget = false;
    /// Must be that of the scene's ContactPolicy.
    PatchStiffness patch = PatchStiffness::per_sphere;
};

/// Finds which near pairs of spheres touch, writes their forces and advances their springs. Each
/// pair writes only its own rows. Spheres are read from packed rows.
System collide_spheres(LawName law, const StepChoices& choices);

/// The same for spheres against facets. Contacts are reduced to one for each feature of a surface;
/// faces take precedence over edges, and edges over vertices.
System collide_facets(LawName law, const StepChoices& choices);

/// The same for spheres against planes.
System collide_planes(LawName law, const StepChoices& choices);

/// The same for spheres against a rigid membrane, which has no friction under any law.
System collide_membrane(LawName law, const StepChoices& choices);

/// The same for spheres against the triangles of a sleeve.
System collide_sleeve(LawName law, const StepChoices& choices);

} // namespace bris

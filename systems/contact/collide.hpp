#pragma once

#include "components/material.hpp"
#include "engine/system.hpp"

namespace bris {

/// What the systems of a step are to do besides.
struct StepChoices {
    bool energy_budget =
        false; ///< book the work that friction, dashpots and rolling take, for each near pair
    PatchStiffness patch = PatchStiffness::per_sphere; ///< as the scene's ContactPolicy
};

/// Finds which near pairs of spheres touch and writes their forces; moves their springs on. Each
/// pair writes only itself. Reads packed rows.
System collide_spheres(LawName law, const StepChoices& choices);

/// The same for spheres against facets: contacts are reduced to one for each feature of a body
/// (face before edge before vertex).
System collide_facets(LawName law, const StepChoices& choices);

/// The same for spheres against planes.
System collide_planes(LawName law, const StepChoices& choices);

/// The same for spheres against a membrane; never friction.
System collide_membrane(LawName law, const StepChoices& choices);

} // namespace bris

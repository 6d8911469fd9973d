#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "engine/simulation.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/output/contacts.hpp"

namespace bris {

// Helpers of small experiments, which build a scene, run it step by step and read its state.

/// Makes a simulation of a complete scene with neighbour lists and steps. Overlap and speed have
/// no practical limit, so that any experiment can be run.
Simulation begin(World world, LawName law, double dt, bool energy_budget = false,
                 unsigned threads = 1);

/// Summary of all touching pairs of the last step.
struct Touch {
    std::size_t pairs = 0;
    double overlap = 0;        ///< m, largest of all pairs
    double normal_force = 0;   ///< N, sum over all pairs
    Vec3 force = Vec3::Zero(); ///< N, sum of the forces on the owners of the pairs
    SpringRow spring{};        ///< of the last pair
    double friction_ratio = 0; ///< largest ratio of tangential to normal force
};
Touch touch_of(const World& world);

/// Kinetic energy (J) of a body on which no force has acted since the last step.
double free_kinetic_energy(World& world, EntityId body);

} // namespace bris

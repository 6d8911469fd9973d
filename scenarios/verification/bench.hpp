#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "engine/simulation.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/output/contacts.hpp"

namespace bris {

// What small experiments share: a scene is built, run step by step, and read.

/// A complete scene with lists and steps, on one thread. Overlaps are not limited: what is asked
/// for is measured.
Simulation begin(World world, LawName law, double dt, bool energy_budget = false,
                 unsigned threads = 1);

/// All touching pairs of the last step, taken together.
struct Touch {
    std::size_t pairs = 0;
    double overlap = 0;        ///< m, the largest
    double normal_force = 0;   ///< N, sum
    Vec3 force = Vec3::Zero(); ///< N, on the owners
    SpringRow spring{};        ///< of the last pair
    double friction_ratio = 0; ///< tangential over normal force, the largest
};
Touch touch_of(const World& world);

/// Kinetic energy (J) of a body that has been free of forces since the last step.
double free_kinetic_energy(World& world, EntityId body);

} // namespace bris

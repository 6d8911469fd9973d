#pragma once

#include "components/material.hpp"
#include "components/settings.hpp"
#include "engine/simulation.hpp"

namespace bris {

/// Settings of the simulation of a scene.
struct StartSettings {
    LawName law = LawName::linear;
    unsigned threads = 1;
    ListSettings lists = {};
    ScheduleSettings schedule = {};
    bool energy_budget = false; ///< accumulates the energy budget
    /// Unbalanced force, relative to the weight, below which bodies sleep (add_sleep); 0: none do.
    double sleep = 0;
    bool divides = true; ///< among the ranks of the run; else each of them computes all
};

/// Makes the simulation of a complete scene: checks the scene, and adds the neighbour lists and the
/// list of steps. Throws InputError if the scene cannot be simulated (check_scene).
Simulation start(World world, const StartSettings& settings);

/// Divides the world among the ranks of the run while it advances, which `start` does.
void divide_among_ranks(Simulation& simulation);

/// The same without the check, for scenes that are tried on purpose.
Simulation start_unchecked(World world, const StartSettings& settings);

} // namespace bris

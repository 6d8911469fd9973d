#pragma once

#include "components/material.hpp"
#include "components/settings.hpp"
#include "engine/simulation.hpp"

namespace bris {

/// How the simulation of a scene is set up.
struct StartSettings {
    LawName law = LawName::linear;
    unsigned threads = 1;
    ListSettings lists = {};
    ScheduleSettings schedule = {};
    bool energy_budget = false; ///< accumulates the energy budget
};

/// The simulation of a complete scene: adds the neighbour lists and the steps. Throws InputError
/// where the scene cannot be simulated (check_scene).
Simulation start(World world, const StartSettings& settings);

} // namespace bris

#pragma once

#include "engine/simulation.hpp"
#include "systems/output/balance.hpp"

#include <cstdint>

namespace bris {

/// Whether a balance means something: an empty or exploded scene is balanced too. It carries load
/// if there are contacts, and at least one for each free body.
bool carries_load(const Balance& balance);

struct EquilibriumSettings {
    double ratio = 1e-3;               ///< of unbalanced to all forces, at which a scene is at rest
    std::uint64_t every = 50;          ///< steps between looks
    std::uint64_t longest = 1'000'000; ///< steps
};

/// Runs until the forces are balanced and something carries them; returns the steps taken. Throws
/// SimulationError after the longest run: "no load path" where the contacts are too few to carry
/// anything, else "no equilibrium".
std::uint64_t find_equilibrium(Simulation& simulation, const EquilibriumSettings& settings = {});

} // namespace bris

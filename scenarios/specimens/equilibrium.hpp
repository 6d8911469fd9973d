#pragma once

#include "engine/simulation.hpp"
#include "systems/output/balance.hpp"

#include <cstdint>

namespace bris {

/// Whether a balance describes a packing that carries load: there are contacts, and at least one
/// for each free body. An empty or exploded scene is balanced too, but carries nothing.
bool carries_load(const Balance& balance);

struct EquilibriumSettings {
    double ratio = 1e-3;               ///< unbalanced force ratio at which a scene is at rest
    std::uint64_t every = 50;          ///< steps between checks
    std::uint64_t longest = 1'000'000; ///< steps after which the search fails
};

/// Runs until the forces are balanced and the packing carries load; returns the number of steps
/// taken. Throws SimulationError after the longest run: "no load path" where there are too few
/// contacts to carry load, otherwise "no equilibrium".
std::uint64_t find_equilibrium(Simulation& simulation, const EquilibriumSettings& settings = {});

} // namespace bris

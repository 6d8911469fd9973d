#pragma once

#include "components/material.hpp"
#include "engine/world.hpp"

#include <cstdint>
#include <string>

namespace bris {

struct Common;

/// Settings of the relaxation of initial overlaps.
struct RelaxSettings {
    /// Largest overlap accepted at the end, relative to the mean diameter of the two partners (at a
    /// boundary: to the diameter of the sphere).
    double overlap = 0.01;
    /// Largest speed accepted at the end, m/s; 0: the speed that a tenth of this overlap would
    /// release.
    double speed = 0;
    double damping = 0.5;              ///< local damping
    double safety = 0.1;               ///< time step relative to the stable step
    std::uint64_t longest = 1'000'000; ///< greatest number of steps
    unsigned threads = 1;
};

/// Result of a relaxation.
struct Relaxed {
    bool done = false;        ///< overlaps and speeds are below their limits
    double first_overlap = 0; ///< largest at the start, relative to the mean diameter
    double overlap = 0;       ///< largest at the end, relative to the mean diameter
    double speed = 0;         ///< m/s, largest at the end, before the bodies were stopped
    double speed_limit = 0;   ///< m/s
    double stored_energy = 0; ///< J, elastic, at the start
    double peak_energy = 0;   ///< J, kinetic, over all inspected steps (every fifth)
    std::uint64_t steps = 0;
    /// If not done: one line with the pair of largest overlap and the fastest body; else empty.
    std::string left;
};

/// Relaxes a start with large overlaps: the bodies push each other apart by the normal springs of
/// their law alone, without gravity or friction, in small steps with local damping. A body that
/// moves against the force on it, or that touches nothing, is stopped. The springs are the only
/// source of energy, so the kinetic energy stays below the elastic energy of the start. Bodies with
/// coincident centres are separated in a direction drawn from their ids. Boundaries stand still.
/// Changes positions and orientations, and sets velocities and angular velocities to zero. The
/// scene must be complete and have no pair lists.
Relaxed relax(World& world, LawName law, const RelaxSettings& settings = {});

/// Relaxes the start of a run and reports by how much. Throws SimulationError if large overlaps are
/// left.
void relax_start(World& world, LawName law, const Common& common);

} // namespace bris

#pragma once

#include "components/material.hpp"
#include "engine/world.hpp"

#include <cstdint>
#include <string>

namespace bris {

/// How a start is relaxed.
struct RelaxSettings {
    double overlap = 0.01; ///< of the mean diameter of two partners (of the sphere's, at a
                           ///< boundary), to end with
    double speed = 0;      ///< m/s, to end with; 0: what a tenth of that overlap would give back
    double damping = 0.5;  ///< local
    double safety = 0.1;   ///< of the stable step
    std::uint64_t longest = 1'000'000; ///< steps
    unsigned threads = 1;
};

/// What relaxing did, and what it left.
struct Relaxed {
    bool done = false;        ///< overlaps and speeds are as small as asked for
    double first_overlap = 0; ///< the largest at the start, of the mean diameter
    double overlap = 0;       ///< at the end
    double speed = 0;         ///< m/s, the largest at the end, before the bodies were stopped
    double speed_limit = 0;   ///< m/s
    double stored_energy = 0; ///< J, elastic, at the start
    double peak_energy = 0;   ///< J, kinetic, in all steps looked at (every fifth)
    std::uint64_t steps = 0;
    std::string left; ///< one line: the deepest pair and the fastest body if not done, else empty
};

/// Brings a start with deep overlaps to rest: the bodies push each other apart under the normal
/// springs of their law alone, without weight or friction, in small steps, with local damping; who
/// moves against his force or touches nothing is stopped. Springs give what they hold and nothing
/// else gives any, so the kinetic energy stays below the elastic energy of the start. Bodies with
/// the same centre part in a direction drawn from their ids. Boundaries stand still. Positions and
/// orientations change, motions become zero. For a complete scene without lists.
Relaxed relax(World& world, LawName law, const RelaxSettings& settings = {});

} // namespace bris

#pragma once

#include "engine/memory.hpp"

namespace bris {

// Peak memory of scenes, which is reached when the pair lists are built: measured by
// tests/performance/peers/scale for 16 000 spheres and more, rounded up.

/// Peak memory of a scene of single spheres, bytes: of each of several ranks if the scene is only
/// observed (Simulation::observe), which is its part, and at the start all bodies without lists.
inline double bytes_of_spheres(double spheres, unsigned ranks = 1) {
    const double share = ranks == 1 ? 1 : 1.0 / ranks + 0.1;
    return bytes_of_process() + 4000 * spheres * share;
}

/// Peak memory of scenes of rocks with `spheres_each` spheres each, bytes; `worlds` scenes exist at
/// the same time.
inline double bytes_of_rocks(double rocks, double spheres_each, double worlds = 1) {
    return bytes_of_process() + worlds * rocks * (4000 + 800 * spheres_each);
}

} // namespace bris

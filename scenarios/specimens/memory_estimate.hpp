#pragma once

#include "engine/memory.hpp"

namespace bris {

// Bytes that scenes take at their most, which is when pair lists are made: what
// tests/performance/peers/scale measures at 16 000 spheres and more, rounded up.

inline double bytes_of_spheres(double spheres) { return bytes_of_process + 4000 * spheres; }

/// Rocks of so many spheres each, in so many worlds at once.
inline double bytes_of_rocks(double rocks, double spheres_each, double worlds = 1) {
    return bytes_of_process + worlds * rocks * (4000 + 800 * spheres_each);
}

} // namespace bris

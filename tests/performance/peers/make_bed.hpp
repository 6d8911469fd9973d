#pragma once

#include "tests/performance/peers/bed.hpp"
#include "tests/performance/peers/scene.hpp"

namespace bris::peers {

/// Makes the bed of a scene: grains on a loose lattice with random velocities settle with local
/// damping under more than their weight, then under their weight. Each stage starts at rest and
/// without contact history, as the runs on the bed do. Single spheres get a random order, as in a
/// bed that was poured at random. The bed of a scene under pressure is such a bed without gravity,
/// between planes at 55 kPa. `spheres` is the number of spheres of settle, quiet and
/// triaxial_spheres; the other scenes have 15 030 spheres of two sizes, or 396 clumps of 30
/// spheres.
Bed make_bed(const Scene& scene, unsigned spheres, unsigned threads);

} // namespace bris::peers

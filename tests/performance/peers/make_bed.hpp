#pragma once

#include "tests/performance/peers/bed.hpp"
#include "tests/performance/peers/scene.hpp"

namespace bris::peers {

/// Makes the bed of a scene: grains on a loose lattice, thrown about, settle with local damping
/// under more than their weight, then under it. Each stage starts at rest and without history, as
/// the runs on the bed will. Single spheres are put in random order, as a bed poured at random
/// would be. A pressed scene's is one of those, without weight between planes at 55 kPa. `spheres`:
/// of settle, quiet and triaxial_spheres; the others have 15 030 of two sizes, and 396 stones
/// of 30.
Bed make_bed(const Scene& scene, unsigned spheres, unsigned threads);

} // namespace bris::peers

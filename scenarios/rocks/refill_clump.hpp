#pragma once

#include "components/clump.hpp"
#include "scenarios/rocks/rock.hpp"

#include <cstdint>

namespace bris {

/// The surface of a clump as seen from its centre of mass, which must lie inside it: triangles
/// between points that are 15 degrees apart. What stands out between them is cut off: 3 to 5 % of
/// the volume of the library's rocks.
Polyhedron surface_of(const Clump& clump);

/// The same rock of `spheres` balls (4 to 1000) in place of its own, in the same frame: volume of
/// the union to 1e-4 and centre of mass to 1e-4 of the size those of the clump; name, size, volume
/// and inertia stay the clump's. About a second for 8 balls. Deterministic in `seed`. Throws
/// InputError as fill_clump.
Clump refilled(const Clump& clump, unsigned spheres, std::uint64_t seed);

} // namespace bris

#pragma once

#include "components/clump.hpp"
#include "scenarios/rocks/rock.hpp"

#include <cstdint>

namespace bris {

/// Surface of a clump seen from its centre of mass, which must lie inside it: triangles between
/// points that are 15 degrees apart. What protrudes between these points is cut off, which is 3 to
/// 5 % of the volume for the rocks of the library. Throws InputError if the centre of mass lies
/// outside the clump.
Polyhedron surface_of(const Clump& clump);

/// Models the same rock by another number of spheres (4 to 1000), in the same frame. The volume of
/// the union agrees with that of the clump to 1e-4 and the centre of mass to 1e-4 of the size;
/// name, size, volume and inertia stay those of the clump. Takes about a second for 8 spheres. The
/// result depends on the arguments and `seed` alone. Throws InputError as fill_clump does.
Clump refilled(const Clump& clump, unsigned spheres, std::uint64_t seed);

} // namespace bris

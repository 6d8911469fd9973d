#pragma once

#include "engine/world.hpp"

#include <cstdint>

namespace bris {

/// Spheres on a loose lattice in a box, the bed on which speed is measured. Defaults are the
/// material of the comparison with other codes.
struct SphereBed {
    unsigned spheres = 2000;
    double radius = 0.01;          ///< m, mean of all
    double size_spread = 0;        ///< radii lie within radius * (1 -+ this), evenly; in [0, 1)
    double normal_stiffness = 1e6; ///< N/m, of a contact; the tangential one is 2/7 of it
    double friction = 0.5;
    double damping_rate = 5838; ///< 1/s, of the normal dashpot; half of it, tangential
    double density = 2600;      ///< kg/m3
    double step = 1e-5;         ///< s
    double start_overlap =
        0; ///< of the mean diameter, of neighbours on the lattice; in [0, 1]; 0: a little room
    std::uint64_t seed = 1;
};

/// Spheres a little out of place on their lattice, in a box about the z axis whose floor is z = 0;
/// settled, they are nearly twice as high as wide. A sphere that leaves the box stops the run. Pair
/// lists are still to be added.
World make_sphere_bed(const SphereBed& bed);

} // namespace bris

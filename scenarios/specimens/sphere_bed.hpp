#pragma once

#include "engine/world.hpp"

#include <cstdint>

namespace bris {

/// Settings of a bed of spheres on a loose lattice in a box, the scene on which speed is measured.
/// The defaults are the material of the comparison with other codes.
struct SphereBed {
    unsigned spheres = 2000;
    double radius = 0.01;   ///< m, mean
    double size_spread = 0; ///< radii are uniform within radius * (1 -+ size_spread); in [0, 1)
    double normal_stiffness = 1e6; ///< N/m, of a contact; the tangential stiffness is 2/7 of it
    double friction = 0.5;         ///< Coulomb coefficient
    double damping_rate = 5838;    ///< 1/s, of the normal dashpot; the tangential one has half
    double density = 2600;         ///< kg/m3
    double step = 1e-5;            ///< s, time step
    /// Overlap of neighbours on the lattice, relative to the mean diameter, in [0, 1]; 0: a small
    /// gap.
    double start_overlap = 0;
    std::uint64_t seed = 1;
};

/// Makes a bed of spheres with small random offsets from their lattice, in a box about the z axis
/// whose floor is z = 0. The settled bed is nearly twice as high as wide. A sphere that leaves the
/// box stops the run. The caller adds the pair lists.
World make_sphere_bed(const SphereBed& bed);

} // namespace bris

#pragma once

#include "engine/options.hpp"
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
    double length_ratio = 1;       ///< length of the floor along x over its width
    /// Overlap of neighbours on the lattice, relative to the mean diameter, in [0, 1]; 0: a small
    /// gap.
    double start_overlap = 0;
    std::uint64_t seed = 1;

    void declare_options(auto& option);
};

/// Makes a bed of spheres with small random offsets from their lattice, in a box about the z axis
/// whose floor is z = 0. The settled bed is nearly twice as high as wide, in y. A sphere that
/// leaves the box stops the run. The caller adds the pair lists.
World make_sphere_bed(const SphereBed& bed);

void SphereBed::declare_options(auto& option) {
    option("spheres", spheres, "", "Number of spheres.", within(1, 50e6));
    option("radius", radius, "m", "Mean radius of the spheres.", above(0, 1e3));
    option("size_spread", size_spread, "",
           "Half width of the uniform distribution of radii, relative to the mean radius.",
           half_open(0, 1));
    option("normal_stiffness", normal_stiffness, "N/m",
           "Normal stiffness of a contact. The tangential stiffness is 2/7 of it.", above(0, 1e15));
    option("friction", friction, "",
           "Coulomb friction coefficient between spheres and between sphere and wall.",
           within(0, 100));
    option("damping_rate", damping_rate, "1/s",
           "Damping rate of the normal dashpot. The tangential one is half of it.", within(0, 1e9));
    option("density", density, "kg/m3", "Density of the spheres.", above(0, 1e6));
    option("step", step, "s", "Time step.", above(0, 1));
    option("length_ratio", length_ratio, "", "Length of the floor over its width.", within(1, 1e4));
    option("start_overlap", start_overlap, "",
           "Overlap of neighbours at the start, relative to the mean diameter.", within(0, 1));
}

} // namespace bris

#pragma once

#include "engine/math.hpp"
#include "engine/run.hpp"

#include <cstdint>

namespace bris {

/// Fines as particles: equal spheres in the voids of a bed, which check the laws by which fields of
/// fines weaken contacts. Real fines are much smaller; so these are fines of the coarsest kind.
struct GrainsOfFines {
    double size = 0.01;                           ///< m, diameter
    std::uint32_t material = 0;                   ///< whose density gives their mass
    double solid_volume = 0;                      ///< m3, of all grains
    Vec3 low = Vec3::Zero(), high = Vec3::Zero(); ///< m, box in which they are placed
};

/// Adds grains at random places in a box, with less than half of their size and clear of all rocks
/// and of each other, until their volume at full size is reached, and returns their number. Their
/// ids follow those of the bodies before. Throws InputError where the voids have no room for them.
std::size_t add_grains(World& world, const GrainsOfFines& grains, std::uint64_t seed);

/// Number of the grains of a bed (RockBed).
std::size_t grains_in(const World& world);

/// Lets the grains of a bed (RockBed) grow to their full size (m) in place. `safety`: see
/// scale_masses. Throws SimulationError where the voids have no room.
Phase grow_grains(double size, double safety);

} // namespace bris

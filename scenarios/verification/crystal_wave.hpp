#pragma once

#include "scenarios/verification/crystal.hpp"

#include <cstdint>

namespace bris {

/// A plane pulse that travels along [100] of a crystal. Spheres of a layer across that direction
/// move alike, so one free sphere stands for each layer; of the others there are those that it or
/// the next layers' spheres touch: images, which are given the place, the velocity and the spin of
/// their layer's free sphere after every step. The outermost layers are held.
struct CrystalWave {
    Crystal crystal;             ///< a friction that holds, as 10
    Vec3 motion = Vec3(1, 0, 0); ///< unit: along x a wave of pressure, across it one of shear
    double wavelength = 20;      ///< of the pulse, over the spacing, > 0
    double path = 20; ///< over the spacing: between the two layers at which its peak is timed, > 0
    double amplitude =
        1e-3;          ///< velocity over sqrt(F h / m), F and h force and overlap of a contact
    double step = 0.1; ///< dt over sqrt(m / k), k the tangent normal stiffness; the crystals'
                       ///< limits are 0.3 to 1
};
struct CrystalWaveResult {
    double speed = 0; ///< m/s, of the peak of velocity
    double amplitude =
        0; ///< of the peak at the far layer, over half of the one given: d'Alembert's
    std::uint64_t steps = 0;
};
/// A stretch of the crystal at rest is given the velocities of one period of 1 + cos, of which one
/// half runs either way. Slower than sqrt(modulus / density) by the lattice's dispersion: by (pi h
/// / wavelength)^2 / 6 for a wave of that length and layers h apart, up to three times that for the
/// peak of a pulse; and by half the pressure over the modulus.
CrystalWaveResult run_experiment(const CrystalWave& wave);

} // namespace bris

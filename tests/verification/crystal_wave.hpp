#pragma once

#include "tests/verification/crystal.hpp"

#include <cstdint>

namespace bris {

/// A plane pulse that travels along [100] of a crystal. All spheres of a layer perpendicular to
/// that direction move in the same way, so one free sphere represents each layer. The other spheres
/// that it or the spheres of the next layers touch are images: after every step they get the
/// displacement, velocity and angular velocity of their layer's free sphere. The outermost layers
/// are held.
struct CrystalWave {
    Crystal crystal;             ///< with a friction that prevents slip, such as 10
    Vec3 motion = Vec3(1, 0, 0); ///< unit vector: along x a pressure wave, across x a shear wave
    double wavelength = 20;      ///< of the pulse, relative to the spacing, > 0
    double path = 20; ///< distance of the layers at which the peak is timed, in spacings, > 0
    /// Velocity relative to sqrt(F h / m), with force F and overlap h of a contact.
    double amplitude = 1e-3;
    /// dt / sqrt(m / k) with the tangent normal stiffness k. The crystals' stability limits are 0.3
    /// to 1.
    double step = 0.1;
};
struct CrystalWaveResult {
    double speed = 0; ///< m/s, of the velocity peak
    /// Velocity of the peak at the far layer, relative to half the initial one (d'Alembert).
    double amplitude = 0;
    std::uint64_t steps = 0;
};
/// Runs the experiment: a section of the crystal at rest gets the velocities of one period of
/// 1 + cos, half of which travels in each direction. The speed is below sqrt(modulus / density)
/// because of the lattice's dispersion, by (pi h / wavelength)^2 / 6 for a wave of that length and
/// layers at a distance h and by up to three times as much for the peak of a pulse, and by half the
/// pressure over the modulus. Throws InputError for settings that are not above 0, SimulationError
/// if the pulse does not arrive.
CrystalWaveResult run_experiment(const CrystalWave& wave);

} // namespace bris

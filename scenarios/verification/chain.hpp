#pragma once

#include "components/material.hpp"

#include <cstdint>
#include <vector>

namespace bris {

/// A straight chain of beads between two held ones, pressed together, in one of its standing waves.
struct ChainWave {
    unsigned beads = 31;  ///< that move, >= 1
    unsigned mode = 1;    ///< half waves, 1 to beads
    double radius = 0.01; ///< m
    Material material;
    LawName law = LawName::linear_frictionless;
    double overlap = 1e-2;   ///< of the radius, before the wave, > 0
    double amplitude = 1e-1; ///< of the overlap, < 1
    double step = 0.1;       ///< dt over sqrt(m/k), k the tangent stiffness of a contact, < 1
    double periods = 20;
};
struct ChainWaveResult {
    double frequency = 0;          ///< rad/s, from the phase after all periods
    double exact_frequency = 0;    ///< rad/s: 2 sqrt(k/m) sin(q/2), q = pi mode / (beads + 1)
    double discrete_frequency = 0; ///< rad/s: of the leapfrog, 2/dt asin(exact dt/2)
    double amplitude_drift = 0;
    double stiffness = 0; ///< N/m, tangent
    std::uint64_t steps = 0;
};
/// The frequency of the engine's chain is that of the leapfrog to rounding for linear contacts; for
/// Hertz's to second order in the amplitude.
ChainWaveResult run_experiment(const ChainWave& chain);

/// A chain of beads that just touch; the first is thrown at the others: Nesterenko's solitary wave.
struct ChainPulse {
    unsigned beads = 100; ///< >= 10
    double radius = 0.01; ///< m
    Material material;
    LawName law = LawName::hertz_frictionless;
    double speed = 1e-2; ///< m/s, of the first bead, > 0
    double step = 0.01;  ///< dt over (m^2 / (K^2 v0))^(1/5), Hertz; over sqrt(m/k), linear
    double front = 0.6, rear = 0.8; ///< of the chain: between these beads speed is measured
};
struct ChainPulseResult {
    // in the units of m, K and v0: time (m^2 / (K^2 v0))^(1/5), force (K^2 m^3 v0^6)^(1/5); linear:
    // sqrt(m/k), v0 sqrt(k m)
    double pulse_speed = 0;      ///< beads a unit of time
    double largest_force = 0;    ///< of the leading pulse
    double largest_velocity = 0; ///< of a bead, over v0
    std::vector<double> arrival; ///< time of the largest force of contact i (beads i and i + 1)
    double time_unit = 0;        ///< s
    double momentum_change = 0;  ///< of m v0
    std::uint64_t steps = 0;
};
ChainPulseResult run_experiment(const ChainPulse& chain);

} // namespace bris

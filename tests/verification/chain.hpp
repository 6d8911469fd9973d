#pragma once

#include "components/material.hpp"

#include <cstdint>
#include <vector>

namespace bris {

/// A standing wave in a straight, compressed chain of beads between two held beads.
struct ChainWave {
    unsigned beads = 31;  ///< number of moving beads, >= 1
    unsigned mode = 1;    ///< number of half waves, 1 to beads
    double radius = 0.01; ///< m
    Material material;
    LawName law = LawName::linear_frictionless;
    double overlap = 1e-2;   ///< before the wave, relative to the radius, > 0
    double amplitude = 1e-1; ///< relative to the overlap, < 1
    double step = 0.1;       ///< dt / sqrt(m/k) with the tangent stiffness k of a contact, < 1
    double periods = 20;     ///< simulated time in periods of the wave
};
struct ChainWaveResult {
    double frequency = 0;          ///< rad/s, from the phase after all periods
    double exact_frequency = 0;    ///< rad/s: 2 sqrt(k/m) sin(q/2), q = pi mode / (beads + 1)
    double discrete_frequency = 0; ///< rad/s, of the leapfrog: 2/dt asin(exact dt/2)
    double amplitude_drift = 0;    ///< relative
    double stiffness = 0;          ///< N/m, tangent stiffness of a contact
    std::uint64_t steps = 0;
};
/// Throws InputError for a mode out of range.
void check(const ChainWave& chain);
/// Runs the experiment. The frequency of the engine's chain equals that of the leapfrog to rounding
/// for linear contacts, and to second order in the amplitude for Hertz contacts. Throws as
/// check.
ChainWaveResult run_experiment(const ChainWave& chain);

/// Nesterenko's solitary wave: the first bead is thrown at a chain of beads that just touch.
struct ChainPulse {
    unsigned beads = 100; ///< >= 10
    double radius = 0.01; ///< m
    Material material;
    LawName law = LawName::hertz_frictionless;
    double speed = 1e-2; ///< m/s, of the first bead, > 0
    double step = 0.01;  ///< dt / (m^2 / (K^2 v0))^(1/5) for Hertz laws, dt / sqrt(m/k) for linear
    /// Positions along the chain, relative to its length, between which the speed is measured.
    double front = 0.6, rear = 0.8;
};
/// Results in units made of m, K and v0: time (m^2 / (K^2 v0))^(1/5), force (K^2 m^3 v0^6)^(1/5).
/// Units of linear laws: time sqrt(m/k), force v0 sqrt(k m).
struct ChainPulseResult {
    double pulse_speed = 0;      ///< beads per unit of time
    double largest_force = 0;    ///< of the leading pulse
    double largest_velocity = 0; ///< of a bead, relative to v0
    std::vector<double> arrival; ///< time of the largest force of contact i (beads i and i + 1)
    double time_unit = 0;        ///< s
    double momentum_change = 0;  ///< relative to m v0
    std::uint64_t steps = 0;
};
/// Throws InputError for fewer than 10 beads, or unless 0 < front < rear < 1.
void check(const ChainPulse& chain);
/// Runs the experiment. Throws as check.
ChainPulseResult run_experiment(const ChainPulse& chain);

} // namespace bris

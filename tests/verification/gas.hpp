#pragma once

#include "components/material.hpp"

#include <cstdint>

namespace bris {

/// A gas of spheres in a smooth box without gravity.
struct Gas {
    unsigned side = 4;    ///< number of spheres along an edge of the initial cube
    double radius = 0.01; ///< m
    Material material;
    LawName law = LawName::hertz_frictionless;
    double speed = 1;               ///< m/s, initial speed of each sphere
    double steps_per_contact = 100; ///< time steps in a normal impact at that speed
    double contacts_long = 60;      ///< simulated time in contact times
    std::uint64_t seed = 1;
};
/// Kinetic plus elastic energy in the course of a run, relative to the initial energy.
struct GasResult {
    double largest_change = 0; ///< largest deviation from the initial energy, of either sign
    double largest_gain = 0;   ///< largest energy above the initial one
    double largest_rise = 0;   ///< largest increase from a sample to any later one
    double last = 1;           ///< energy at the end
    double contacts = 0;       ///< mean number of touching pairs over the samples
    std::uint64_t steps = 0;
};
GasResult run_experiment(const Gas& gas);

/// A normal Hertz impact whose stiffness changes during the contact.
struct Stiffening {
    double factor = 2; ///< by which Young's modulus changes
    double steps_per_contact = 1000;
};
struct StiffeningResult {
    double overlap = 0;  ///< m, when the stiffness changes
    double injected = 0; ///< added energy relative to the kinetic energy before, from the speeds
    double exact = 0;    ///< 8/15 (E2* - E1*) sqrt(R*) overlap^(5/2), relative to the same energy
    double restitution = 0;
};
/// Runs the experiment. Throws SimulationError if the impact does not end.
StiffeningResult run_experiment(const Stiffening& stiffening);

} // namespace bris

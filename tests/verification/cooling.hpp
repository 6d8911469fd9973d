#pragma once

#include "components/material.hpp"

#include <cstdint>

namespace bris {

/// A granular gas in a box: spheres lose energy in collisions with each other, without friction,
/// gravity or losses at the walls. Haff (1983): T = T0 / (1 + t / t0)^2.
struct Cooling {
    unsigned side = 8;    ///< number of spheres along an edge of the initial cube
    double radius = 0.01; ///< m
    double pitch = 1.9;   ///< initial spacing relative to the diameter, > 1
    Material material;    ///< restitution in (0, 1)
    LawName law = LawName::linear_viscous;
    double speed = 1;              ///< m/s, initial speed of each sphere
    double steps_per_contact = 20; ///< time steps in a normal impact at that speed
    /// Temperatures, relative to the initial one, between which the law is fitted.
    double from = 0.5, to = 0.05;
    std::uint64_t seed = 1;
};
struct CoolingResult {
    double r_squared = 0; ///< of the straight line fitted to 1/sqrt(T) over time
    double time = 0;      ///< t0 of the fit, in units of diameter / speed
    std::size_t samples = 0;
    std::uint64_t steps = 0;
};
/// Runs the experiment. Throws InputError for settings out of range, SimulationError if the gas
/// does not reach the final temperature.
CoolingResult run_experiment(const Cooling& cooling);

} // namespace bris

#pragma once

#include "components/material.hpp"

#include <cstdint>

namespace bris {

/// A gas of spheres that lose energy when they meet, without friction, weight or loss at the walls
/// of its box: Haff (1983), T = T0 / (1 + t / t0)^2.
struct Cooling {
    unsigned side = 8;    ///< spheres along an edge of the cube that they start in
    double radius = 0.01; ///< m
    double pitch = 1.9;   ///< of their places at the start, over the diameter, > 1
    Material material;    ///< restitution in (0, 1)
    LawName law = LawName::linear_viscous;
    double speed = 1;              ///< m/s, of each at the start
    double steps_per_contact = 20; ///< of a normal impact at that speed
    double from = 0.5,
           to = 0.05; ///< temperatures between which the law is fitted, over that at the start
    std::uint64_t seed = 1;
};
struct CoolingResult {
    double r_squared = 0; ///< of the straight line of 1/sqrt(T) over time
    double time = 0;      ///< t0 of the fit, over diameter / speed
    std::size_t samples = 0;
    std::uint64_t steps = 0;
};
CoolingResult run_experiment(const Cooling& cooling);

} // namespace bris

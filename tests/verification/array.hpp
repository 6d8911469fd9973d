#pragma once

#include "scenarios/collision/impact.hpp"

#include <vector>

namespace bris {

/// Many spheres side by side hit a plane in one scene, each at its own angle (MFiX DEM05).
struct ImpactArray {
    Impact impact;       ///< of each sphere on a plane; its angle is not used
    unsigned count = 93; ///< number of spheres
    double least_angle = 0.05, greatest_angle = 1.48; ///< rad, of evenly spaced angles
};
struct ImpactArrayResult {
    std::vector<double> angle, tangential_restitution; ///< rad; -
    /// Largest difference between an impact in the array and the same impact alone, in velocity and
    /// in surface speed of rotation, both relative to the impact speed.
    double largest_difference = 0;
};
ImpactArrayResult run_experiment(const ImpactArray& array);

} // namespace bris

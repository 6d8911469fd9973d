#pragma once

#include "scenarios/verification/impact.hpp"

#include <vector>

namespace bris {

/// Many spheres side by side meet a plane at once, each at its own angle (MFiX DEM05).
struct ImpactArray {
    Impact impact; ///< of each, on a plane; its angle is not used
    unsigned count = 93;
    double least_angle = 0.05, greatest_angle = 1.48; ///< rad, evenly between
};
struct ImpactArrayResult {
    std::vector<double> angle, tangential_restitution; ///< rad; -
    double largest_difference =
        0; ///< of velocity (over the speed) and surface speed of spin, from the same impact alone
};
ImpactArrayResult run_experiment(const ImpactArray& array);

} // namespace bris

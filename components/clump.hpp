#pragma once

#include "engine/math.hpp"

#include <string>
#include <vector>

namespace bris {

/// One sphere of a clump in the clump's body frame, m.
struct Ball {
    Vec3 centre;
    double radius;
};

/// Model of a rigid rock by overlapping spheres. Volume and inertia are those of the union. The
/// body frame is the principal frame with its origin at the centre of mass of the union. The
/// library stores clumps at sieve size 1 m, so `scaled(clump, s)` is a rock of sieve size s.
struct Clump {
    std::string name;
    std::vector<Ball> balls;
    double volume = 0;           ///< m³
    Vec3 inertia = Vec3::Zero(); ///< m⁵: principal moments per unit density, about x, y, z
    double bounding_radius = 0;  ///< m, about the centre of mass
    double sieve = 0;            ///< m, side of the smallest square opening that the rock passes
};

/// The same shape, `factor` times as large. `factor` > 0.
inline Clump scaled(const Clump& clump, double factor) {
    Clump result = clump;
    for (Ball& ball : result.balls) ball = {factor * ball.centre, factor * ball.radius};
    const double cubed = factor * factor * factor;
    result.volume *= cubed;
    result.inertia *= cubed * factor * factor;
    result.bounding_radius *= factor;
    result.sieve *= factor;
    return result;
}

} // namespace bris

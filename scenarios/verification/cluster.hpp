#pragma once

#include "components/material.hpp"

#include <cstdint>

namespace bris {

/// A small cloud of spheres that collide with each other and with a moving floor, and how its
/// motion looks in another frame, unit or order: physics must not change.
struct Cluster {
    unsigned side = 3; ///< spheres along an edge of the cube that they start in
    LawName law = LawName::hertz_mindlin_viscous;
    std::uint64_t seed = 1;
    double steps_per_contact = 50;
    unsigned steps = 300;     ///< short of the time in which rounding grows by chaos
    double local_damping = 0; ///< depends on the frame, by its definition
};

/// The same scene otherwise described.
struct Description {
    Vec3 boost = Vec3::Zero();  ///< m/s
    Vec3 offset = Vec3::Zero(); ///< m
    Quat rotation{1, 0, 0, 0};
    bool mirrored = false;                 ///< x to -x
    bool reversed = false;                 ///< ids in the opposite order
    double length = 1, time = 1, mass = 1; ///< units: 1e3 for numbers in mm, ms, g
    unsigned threads = 1;
};

struct Difference {
    double position_difference =
        0;               ///< largest distance between where a sphere is in both, over a radius
    double motion = 0;   ///< largest difference of velocity, over the speed of impact
    double contacts = 0; ///< touching pairs during the run, mean; a run without any proves nothing
};
/// Runs both descriptions and compares them, the second brought back to the first.
Difference compare(const Cluster& cluster, const Description& description);

} // namespace bris

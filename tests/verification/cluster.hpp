#pragma once

#include "components/material.hpp"

#include <cstdint>

namespace bris {

/// A small cloud of spheres that collide with each other and with a floor. Its motion must not
/// depend on the reference frame, the units or the numbering of the spheres.
struct Cluster {
    unsigned side = 3; ///< number of spheres along an edge of the initial cube
    LawName law = LawName::hertz_mindlin_viscous;
    std::uint64_t seed = 1;
    double steps_per_contact = 50;
    unsigned steps = 300;     ///< few enough that rounding errors stay small
    double local_damping = 0; ///< depends on the reference frame by definition
};

/// Another description of the same scene.
struct Description {
    Vec3 boost = Vec3::Zero();  ///< m/s
    Vec3 offset = Vec3::Zero(); ///< m
    Quat rotation{1, 0, 0, 0};
    bool mirrored = false;                 ///< x becomes -x
    bool reversed = false;                 ///< ids are in the opposite order
    double length = 1, time = 1, mass = 1; ///< factors of units: 1e3 for numbers in mm, ms, g
    unsigned threads = 1;
};

struct Difference {
    /// Largest distance between the positions of a sphere in both runs, relative to the radius.
    double position_difference = 0;
    double motion = 0; ///< largest difference of velocity, relative to the impact speed
    /// Mean number of touching pairs during the run. A run without contacts proves nothing.
    double contacts = 0;
};
/// Runs the cluster in its plain description and in another one, transforms the second result back
/// and returns the differences.
Difference compare(const Cluster& cluster, const Description& description);

} // namespace bris

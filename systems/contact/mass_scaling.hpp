#pragma once

#include "engine/world.hpp"

namespace bris {

/// What mass scaling did.
struct MassScaling {
    double dt = 0;             ///< s
    double total_mass = 0;     ///< kg, scaled, of free bodies
    double largest_factor = 0; ///< of scaled to true mass
    double smallest_factor = 0;
};

/// Gives every free clump the inertial mass and inertia with which the step `dt` is `safety` times
/// its stable step; for quasi-static runs (equilibria do not depend on mass). A body counts at
/// least six contacts, for those that may come. With dt = 0 the step is chosen so that the total
/// mass stays the true one. Scaled masses never shrink if `only_raise`. Weight keeps the true mass.
/// For laws without dashpots, whose rates would grow with the masses.
MassScaling scale_masses(World& world, double dt, double safety, bool only_raise);

} // namespace bris

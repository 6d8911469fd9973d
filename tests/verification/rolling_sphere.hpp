#pragma once

#include "components/material.hpp"

#include <cstdint>

namespace bris {

/// A sphere on a horizontal or inclined plane that slides, rolls or stays at rest. It moves along
/// x, downhill, and rolls about y.
struct RollingSphere {
    double radius = 0.01; ///< m
    Material material;    ///< of sphere and plane, with the stiffnesses of linear_material
    LawName law = LawName::linear_viscous;
    ContactPolicy policy;
    double gravity = 9.81;       ///< m/s2
    double slope = 0;            ///< rad, in [0, pi/2)
    double speed = 0;            ///< m/s, initial
    double angular_velocity = 0; ///< rad/s about y, initial
    double twist = 0;            ///< rad/s about the normal, initial
    double duration = 0.1;       ///< s
    double step = 0.1;           ///< dt / sqrt(m/k)
};
struct RollingSphereResult {
    double slip_end = 0; ///< s, when friction falls below Coulomb's limit; NaN if it never does
    double speed = 0, angular_velocity = 0, twist = 0; ///< m/s, rad/s and rad/s, at the end
    /// Mean accelerations over the second half of the run, m/s2 and rad/s2.
    double acceleration = 0;
    double angular_acceleration = 0, twist_acceleration = 0;
    double kinetic_energy = 0;       ///< J, at the end
    double first_kinetic_energy = 0; ///< J, at the start
    double friction_ratio = 0;       ///< largest ratio of tangential to normal force
    std::uint64_t steps = 0;
};
/// Runs the experiment. Throws InputError for a Hertz law or a slope out of range.
RollingSphereResult run_experiment(const RollingSphere& roll);

} // namespace bris

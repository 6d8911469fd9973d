#pragma once

#include "components/material.hpp"

#include <cstdint>

namespace bris {

/// A sphere on a plane, which may slope: it slides, rolls, or stays. Motion is along x, downhill;
/// rolling is spin about y.
struct RollingSphere {
    double radius = 0.01;
    Material material; ///< of both, with the stiffnesses of linear_material
    LawName law = LawName::linear_viscous;
    ContactPolicy policy;
    double gravity = 9.81;       ///< m/s2
    double slope = 0;            ///< rad, in [0, pi/2)
    double speed = 0;            ///< m/s, at the start
    double angular_velocity = 0; ///< rad/s about y, at the start
    double twist = 0;            ///< rad/s about the normal, at the start
    double duration = 0.1;       ///< s
    double step = 0.1;           ///< dt over sqrt(m/k)
};
struct RollingSphereResult {
    double slip_end = 0; ///< s, when friction falls below Coulomb's limit; nan if it never does
    double speed = 0, angular_velocity = 0, twist = 0;       ///< m/s, rad/s, at the end
    double acceleration = 0;                                 ///< m/s2, mean over the second half
    double angular_acceleration = 0, twist_acceleration = 0; ///< rad/s2, likewise
    double kinetic_energy = 0;                               ///< J, at the end
    double first_kinetic_energy = 0;                         ///< J, at the start
    double friction_ratio = 0; ///< largest tangential over normal force
    std::uint64_t steps = 0;
};
RollingSphereResult run_experiment(const RollingSphere& roll);

} // namespace bris

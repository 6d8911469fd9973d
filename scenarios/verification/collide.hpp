#pragma once

#include "components/material.hpp"
#include "engine/math.hpp"
#include "systems/fusion/sensor_filter.hpp"

#include <vector>

namespace bris {

/// A ball with a sensor flies into others at rest, without weight (Liu, Huang, Qiu and Shen 2018,
/// J. Comput. Civ. Eng.: two balls centre to centre, two off centre, many). A true run is recorded
/// by the first ball's sensor; a model with another speed, path and restitution is run without and
/// with the recording. How well does it then know the others?
struct Collide {
    unsigned balls = 2;    ///< with the first; from 2 on. Those that are hit lie in a triangle
    double radius = 0.025; ///< m, > 0
    double offset = 0;     ///< radii, of the path from the middle of the ball that is hit; within 2
    double gap = 0.2;      ///< m, that the ball flies first
    double after = 0.1;    ///< s, that is run after the first touch
    double speed = 1;      ///< m/s, > 0
    Material material;     ///< of all balls
    LawName law = LawName::hertz_mindlin_viscous;
    double steps_per_contact = 50;
    // what the model takes for true
    double model_speed = 1.1;      ///< of the speed
    double model_offset = 0;       ///< radii, besides the offset
    double model_restitution = -1; ///< below 0: the true one
    // what is measured of the first ball, and how it is used
    double sampling_rate = 200; ///< Hz
    double position_noise = 1e-4,
           velocity_noise = 1e-3; ///< m and m/s, deviations; below 0: not measured
    FilterSettings filter;
    unsigned injection_steps = 1;
    std::uint64_t seed = 1;
};

struct CollideResult {
    std::vector<Vec3> truth, free, fused; ///< m/s, velocities of all balls at the end
    double free_error = 0,
           fused_error = 0; ///< m/s, root mean square over the balls without a sensor
    double error_at_touch =
        0; ///< m/s, of the first ball when it touches in the fused run, along the line of centres
    double carried_error = 0;  ///< m/s, of the second ball along that line, in the fused run
    double expected_error = 0; ///< m/s, the same by momentum: centre to centre (1 + e) m1 / (m1 +
                               ///< m2) of the error at touch
    /// m/s, error of the second ball's velocity, and that by momentum: of two balls without
    /// friction, which push each other along their line of centres at the touch, and it may be
    /// another one than the true one.
    Vec3 carried = Vec3::Zero(), expected = Vec3::Zero();
    std::uint64_t accepted = 0, refused = 0; ///< vectors measured
    double fusion_work = 0;                  ///< J, booked
    double energy_error =
        0; ///< J, that energies at start and end, work of fusion and dashpots leave open
    std::uint64_t steps = 0;
};

/// Throws InputError if the numbers are out of range.
CollideResult run_experiment(const Collide& collide);

} // namespace bris

#pragma once

#include "components/material.hpp"
#include "engine/math.hpp"
#include "systems/fusion/sensor_filter.hpp"

#include <vector>

namespace bris {

/// A ball with a sensor collides with balls at rest, without gravity (Liu, Huang, Qiu and Shen
/// 2018, J. Comput. Civ. Eng.: two balls head-on, two balls off centre, many balls). The first
/// ball's sensor records a true run. A model with another speed, path and restitution is run
/// without and with the recording, and the errors of the other balls are compared.
struct Collide {
    unsigned balls = 2;    ///< number of balls, >= 2; the balls that are hit form a triangle
    double radius = 0.025; ///< m, > 0
    double offset = 0; ///< radii, distance of the path from the centre of the ball that is hit, < 2
    double gap = 0.2;  ///< m, distance that the first ball flies before the collision
    double after = 0.1; ///< s, simulated time after the first touch
    double speed = 1;   ///< m/s, > 0
    Material material;  ///< of all balls
    LawName law = LawName::hertz_mindlin_viscous;
    double steps_per_contact = 50;
    // assumptions of the model
    double model_speed = 1.1;      ///< relative to the true speed
    double model_offset = 0;       ///< radii, added to the offset
    double model_restitution = -1; ///< below 0: the true one
    // measurements of the first ball and their use
    double sampling_rate = 200; ///< Hz
    /// Standard deviations, m and m/s. Below 0: the quantity is not measured.
    double position_noise = 1e-4, velocity_noise = 1e-3;
    FilterSettings filter;
    unsigned injection_steps = 1;
    std::uint64_t seed = 1;
};

struct CollideResult {
    std::vector<Vec3> truth, free, fused; ///< m/s, velocities of all balls at the end
    /// Root mean square errors of the velocities of all balls without a sensor, m/s.
    double free_error = 0, fused_error = 0;
    /// Error of the first ball's velocity at the touch, along the line of centres, in the fused
    /// run, m/s.
    double error_at_touch = 0;
    double carried_error = 0; ///< m/s, error of the second ball along that line in the fused run
    /// The same error as it follows from momentum, m/s: (1 + e) m1 / (m1 + m2) of the error at the
    /// touch in a head-on collision.
    double expected_error = 0;
    /// Error of the second ball's velocity, and the error that follows from momentum for two balls
    /// without friction, which push each other along the line of centres at the touch, m/s. The
    /// line of centres in the fused run may differ from the true one.
    Vec3 carried = Vec3::Zero(), expected = Vec3::Zero();
    std::uint64_t accepted = 0, refused = 0; ///< numbers of measured vectors
    double fusion_work = 0;                  ///< J, as accumulated in the energy budget
    /// Error of the energy budget: energies at start and end, work of fusion, dissipated work, J.
    double energy_error = 0;
    std::uint64_t steps = 0;
};

/// Throws InputError if the numbers are out of range.
void check(const Collide& collide);
/// Runs the experiment. Throws as check.
CollideResult run_experiment(const Collide& collide);

} // namespace bris

#pragma once

#include "components/sensor.hpp"
#include "systems/loads/element.hpp"

namespace bris {

/// Nudging instead of direct insertion: a spring towards the target pose, up to a force at which
/// contacts yield, and a dashpot that makes the motion critically damped (Den Hartog, Mechanical
/// Vibrations, 1956, chapter 2).
struct NudgingSettings {
    /// N/m; 0: direct insertion instead of nudging. Larger values than m (0.5 / dt)^2, which the
    /// time step still resolves, act as that value.
    double stiffness = 0;
    double largest_force = 0; ///< N, limit of the spring force and of the sum with the dashpot
    double arm = 0.01; ///< m, lever arm that converts stiffness and force to those of rotation
};

/// Spring and dashpot that nudge a sensor's body towards its target pose (nudge_clumps) until the
/// next analysis. In a staged test (Fusion::by_strain) they act to the end of the stage; from there
/// to the next analysis their force is held constant (hold_nudging_forces).
struct NudgingRow {
    /// N and N m: sum of spring and dashpot in the last step.
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    /// m and m/s: target position, and the velocity at which the target moves.
    Vec3 position = Vec3::Zero(), velocity = Vec3::Zero();
    Vec3 angular_velocity = Vec3::Zero(); ///< rad/s, at which the target rotates
    /// Target attitude. Of a sphere, which has no attitude: the remaining rotation to the target.
    Quat attitude = Quat::Identity();
    double stiffness = 0, turn_stiffness = 0;     ///< N/m and N m/rad; 0: no nudging
    double largest_force = 0, largest_torque = 0; ///< N and N m
    double held = 0;                              ///< 1: force and torque stay constant
    bool is_active() const { return stiffness > 0 || turn_stiffness > 0; }
};
struct Nudging : State<NudgingRow>, ElementDefaults {
    static constexpr auto name = "nudging", unit = "N, N m, m, m/s, rad/s, 1, N/m";
    static constexpr auto plural = "nudged bodies";

    using Acting = Nudging;
    using Work = FusionWork; // accumulated with the forces; corrections add to it, too
    /// It acts on the whole rock, as the weight does.
    static constexpr bool counts_as_weight = true;
    static StepList force_systems();
};
static_assert(sizeof(NudgingRow) == 24 * sizeof(double)); // no padding: every byte is saved

/// Target pose of a body and the velocities of the target.
struct NudgingTarget {
    Vec3 position, velocity; ///< m, m/s
    /// Of a sphere: the remaining rotation one step ago, which nudge_spheres advances over that
    /// step.
    Quat attitude;
    Vec3 angular_velocity; ///< rad/s
};

/// Nudges a body towards the target from now on.
void set_nudging(NudgingRow& row, std::uint32_t& guided, const NudgingTarget& target,
                 const NudgingSettings& settings);

/// Keeps the force and torque of all nudging constant from now on, because the targets are no
/// longer known: to be called before the platens of a staged test move.
void hold_nudging_forces(World& world);

} // namespace bris

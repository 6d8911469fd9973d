#pragma once

#include "components/body.hpp"

#include <cstdint>
#include <vector>

namespace bris {

/// Bodies at rest are held in place and skipped by the step until the force of a partner wakes
/// them. This is an approximation, and off unless a scene asks for it (add_sleep). A free body
/// falls asleep after `steps` consecutive steps in which the unbalanced force and torque on it
/// could not accelerate it by more than `acceleration` and no point of it moved faster than
/// `speed`. It wakes when the unbalanced force or torque exceeds twice that limit. Where all bodies
/// sleep, the forces on each balance its weight to within the fraction 2 acceleration / g.
struct Sleep {
    static constexpr auto name = "sleep";
    double acceleration = 0.01 * 9.81; ///< m/s2, > 0
    double speed = 1e-4;               ///< m/s, > 0
    unsigned steps = 100;              ///< > 0
    /// A body that has fallen asleep no longer moves, so that the forces of its contacts change
    /// once more; a contact that has just ended changes them twice. It and its partners are
    /// therefore computed for as many steps before it is settled.
    static constexpr unsigned settling = 2;
    enum class State : std::uint8_t { awake, asleep, settled };
    // what the last review_sleep has left
    std::vector<State> states = {}; ///< by row
    /// By row: 1 if the body is not settled or has a near pair with such a body.
    std::vector<std::uint8_t> busy = {};
    bool all = false; ///< the contacts of all bodies are computed in this step
};

/// Number of consecutive steps in which the body was at rest; from Sleep::steps on it sleeps. It is
/// not counted beyond Sleep::steps + Sleep::settling.
struct Resting : State<std::uint32_t> {
    static constexpr auto name = "resting", unit = "";
};
/// Pose in which a sleeping body is held.
struct HeldRow {
    Vec3 position = Vec3::Zero();
    double qx = 0, qy = 0, qz = 0, qw = 0, held = 0;
};
struct HeldPose : State<HeldRow> {
    static constexpr auto name = "held_pose", unit = "m";
};

} // namespace bris

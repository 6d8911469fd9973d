#pragma once

#include "engine/component.hpp"
#include "engine/entity.hpp"
#include "engine/math.hpp"

namespace bris {

struct Sensors {
    static constexpr auto name = "sensors";
};

// A SmartRock in the scene: the body that it is, and how far its recording has been used.
struct SensorId : State<EntityId> {
    static constexpr auto name = "id", unit = "";
    static constexpr bool is_key = true;
};
struct SensorHost : State<EntityId> {
    static constexpr auto name = "host", unit = "";
};
struct NextSample : State<std::uint64_t> {
    static constexpr auto name = "next_sample", unit = "";
}; // of its recording
struct Accepted : State<std::uint64_t> {
    static constexpr auto name = "accepted", unit = "";
}; // vectors measured
struct Refused : State<std::uint64_t> {
    static constexpr auto name = "refused", unit = "";
}; // likewise: too far from the forecast, or told before
struct TooLate : State<std::uint64_t> {
    static constexpr auto name = "too_late", unit = "";
}; // samples, later than the filter looks back
struct Reduced : State<std::uint64_t> {
    static constexpr auto name = "reduced", unit = "";
}; // corrections followed in part only: too far for a step
struct Withheld : State<std::uint64_t> {
    static constexpr auto name = "withheld", unit = "";
}; // not at all: much too far
struct LargestInnovation : State<double> {
    static constexpr auto name = "largest_innovation", unit = "";
}; // chi square of three degrees

/// How a body's motion is to be corrected: a part of the way in each of the steps to come.
/// `as_motion` 1: as motion, which friction feels; 0: the body is put there. A row of zeros is no
/// correction.
struct CorrectionRow {
    Vec3 shift = Vec3::Zero(), turn = Vec3::Zero();           ///< m and rad, in a step
    Vec3 last_shift = Vec3::Zero(), last_turn = Vec3::Zero(); ///< in the step before
    double steps = 0, as_motion = 0;
};
struct Correction : State<CorrectionRow> {
    static constexpr auto name = "correction", unit = "m, rad";
};
/// A spring and a dashpot that pull a sensor's body to where it should be (nudge_clumps), until it
/// is told anew; in a test by stages to the end of the stage, from where on their force is held
/// constant until then (hold_nudging_forces).
struct NudgingRow {
    Vec3 force = Vec3::Zero(),
         torque = Vec3::Zero(); ///< N and N m, of both together, in the last step
    Vec3 position = Vec3::Zero(),
         velocity = Vec3::Zero();         ///< m and m/s: where it should be, and how that moves on
    Vec3 angular_velocity = Vec3::Zero(); ///< rad/s
    Quat attitude = Quat::Identity();     ///< that it should have; of a sphere, which has none: the
                                          ///< rotation still to go
    double stiffness = 0, turn_stiffness = 0;     ///< N/m and N m/rad; 0: nothing pulls
    double largest_force = 0, largest_torque = 0; ///< N and N m
    double held = 0;                              ///< 1: force and torque stay as they are
    bool is_active() const { return stiffness > 0 || turn_stiffness > 0; }
};
struct Nudging : State<NudgingRow> {
    static constexpr auto name = "nudging", unit = "N, N m, m, m/s, rad/s, 1, N/m";
};
static_assert(sizeof(NudgingRow) == 24 * sizeof(double)); // no gaps: all of it is saved
/// 1 while a body is corrected or pulled, and in the step after: few are, and the others are not
/// looked at.
struct Guided : State<std::uint32_t> {
    static constexpr auto name = "guided", unit = "";
};
/// Energy that corrections have put into the scene, since the start.
struct FusionWork : State<double> {
    static constexpr auto name = "fusion_work", unit = "J";
};

} // namespace bris

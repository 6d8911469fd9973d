#pragma once

#include "engine/math.hpp"

#include <vector>

namespace bris {

/// Angles (rad) of an attitude q, body to world, in the convention of aviation and of vehicles
/// (intrinsic rotations yaw, pitch, roll): q = Rz(yaw) Ry(pitch) Rx(roll), with x along the track,
/// y along the tie, and z upwards. Positive angles are right-handed about these axes.
struct RollPitchYaw {
    double roll = 0, pitch = 0, yaw = 0;
};

Quat quaternion_of(const RollPitchYaw& angles);

/// Roll and yaw in [-pi, pi], pitch in [-pi/2, pi/2]. At a pitch of +-pi/2 only yaw -+ roll is
/// determined; there the roll is 0. Error below 1e-7 rad there, below 1e-14 elsewhere.
RollPitchYaw roll_pitch_yaw_of(const Quat& attitude);

/// The angles of a series of attitudes without jumps: each attitude has two sets of angles, (r, p,
/// y) and (r + pi, pi - p, y + pi), plus any multiples of 2 pi; the one nearest to the angles
/// before is taken, so that pitch may pass +-pi/2. At a pitch of +-pi/2 the roll is that before.
std::vector<RollPitchYaw> unwrapped_roll_pitch_yaw(const std::vector<Quat>& attitudes);

/// Adds multiples of 2 pi to the angles (rad), so that neighbours differ by pi at most.
std::vector<double> unwrapped(std::vector<double> angles);

} // namespace bris

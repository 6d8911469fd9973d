#pragma once

#include "engine/signal/median.hpp"
#include "scenarios/sensors/recording.hpp"

#include <algorithm>
#include <vector>

namespace bris {

/// Median of the first hundred samples of the specific force, m/s2; zero: none.
inline Vec3 first_force(const Recording& recording) {
    const std::size_t count = std::min<std::size_t>(recording.force.size(), 100);
    if (count == 0) return Vec3::Zero();
    return median(std::vector<Vec3>(recording.force.begin(),
                                    recording.force.begin() + static_cast<std::ptrdiff_t>(count)));
}

/// Sets the attitude at the start as gravity shows it in the first samples: that force points up,
/// the yaw is not known.
inline void set_attitude_by_gravity(Recording& recording) {
    if (const Vec3 up = first_force(recording); up.allFinite() && up.norm() > 0)
        recording.info.set_pose(recording.info.position(), Quat::FromTwoVectors(up, Vec3::UnitZ()));
}

} // namespace bris

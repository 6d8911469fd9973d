#pragma once

#include "components/body.hpp"
#include "engine/lane_math.hpp"

namespace bris {

/// Writes the motion rows of lane_count bodies: velocity (m/s), inverse mass (1/kg, 0 if driven)
/// and angular velocity (rad/s).
inline void store_motion(MotionRow* motion, LaneRows rows, const Vec3Lanes& v,
                         const Lane& inverse_mass, const Vec3Lanes& omega) {
    const ByRow at(rows);
    store_rows(transpose({v.x, v.y, v.z, inverse_mass}), rows.count,
               [&](int q) { return &motion[at(q)].vx; });
    store_rows(transpose({omega.x, omega.y, omega.z, Lane{}}), rows.count,
               [&](int q) { return &motion[at(q)].omega_x; });
}

} // namespace bris

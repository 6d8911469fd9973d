#pragma once

#include "engine/math.hpp"

namespace bris {

/// True motion of a body at one time, in the world frame.
struct TrueMotion {
    Quat orientation = Quat::Identity();
    Vec3 acceleration = Vec3::Zero();         ///< m/s2
    Vec3 angular_velocity = Vec3::Zero();     ///< rad/s
    Vec3 angular_acceleration = Vec3::Zero(); ///< rad/s2
};

} // namespace bris

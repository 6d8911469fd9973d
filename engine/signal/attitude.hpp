#pragma once

#include "engine/math.hpp"

namespace bris {

// Not inline: whoever includes this would instantiate Eigen's products again.

/// Rotation vector (rad) of a unit quaternion, with length up to pi: the inverse of
/// exponential_map.
Vec3 rotation_vector(const Quat& q);

/// The rotation vector, in world axes, that leads from `estimate` to `truth`.
Vec3 attitude_error(const Quat& truth, const Quat& estimate);

/// The shortest rotation that leads from the direction of one vector to that of another; for
/// opposite vectors, half a turn about any axis perpendicular to them. Eigen's FromTwoVectors has
/// the same bits but for opposite vectors, where it contains a singular value decomposition, which
/// takes five seconds to compile.
Quat shortest_rotation(const Vec3& from, const Vec3& to);

/// The matrix of the cross product with v.
Mat3 cross_matrix(const Vec3& v);

/// Mean of the rotations from 0 to v: int_0^1 exp([v x] s) ds (the left Jacobian of the exponential
/// map), to the order v^5.
Mat3 mean_rotation(const Vec3& v);

} // namespace bris

#pragma once

#include "engine/math.hpp"

namespace bris {

/// Rotation vector (rad) of a unit quaternion, with length up to pi: the inverse of
/// exponential_map.
inline Vec3 rotation_vector(const Quat& q) {
    const double sine = q.vec().norm(), angle = 2 * std::atan2(sine, std::abs(q.w()));
    const double scale = sine > 1e-150 ? angle / sine : 2;
    return (q.w() < 0 ? -scale : scale) * q.vec();
}

/// The rotation vector, in world axes, that leads from `estimate` to `truth`.
inline Vec3 attitude_error(const Quat& truth, const Quat& estimate) {
    return rotation_vector(truth * estimate.conjugate());
}

/// The shortest rotation that leads from the direction of one vector to that of another; for
/// opposite vectors, half a turn about any axis perpendicular to them. Eigen's FromTwoVectors has
/// the same bits but for opposite vectors, where it contains a singular value decomposition, which
/// takes five seconds to compile.
inline Quat shortest_rotation(const Vec3& from, const Vec3& to) {
    const Vec3 a = from.normalized(), b = to.normalized();
    const double cosine = b.dot(a);
    Quat q;
    if (cosine < -1 + 1e-12) {
        q.w() = 0;
        q.vec() = a.unitOrthogonal();
        return q;
    }
    const double twice_w = std::sqrt((1 + cosine) * 2);
    q.vec() = Vec3(a.cross(b)) * (1 / twice_w);
    q.w() = twice_w * 0.5;
    return q;
}

/// The matrix of the cross product with v.
inline Mat3 cross_matrix(const Vec3& v) {
    Mat3 m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

/// Mean of the rotations from 0 to v: int_0^1 exp([v x] s) ds (the left Jacobian of the exponential
/// map), to the order v^5.
inline Mat3 mean_rotation(const Vec3& v) {
    const Mat3 k = cross_matrix(v), k2 = k * k;
    return Mat3::Identity() + k / 2 + k2 / 6 + k2 * k / 24 + k2 * k2 / 120;
}

} // namespace bris

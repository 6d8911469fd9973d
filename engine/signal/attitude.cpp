#include "engine/signal/attitude.hpp"

#include <cmath>

namespace bris {

Vec3 rotation_vector(const Quat& q) {
    const double sine = q.vec().norm(), angle = 2 * std::atan2(sine, std::abs(q.w()));
    const double scale = sine > 1e-150 ? angle / sine : 2;
    return (q.w() < 0 ? -scale : scale) * q.vec();
}

Vec3 attitude_error(const Quat& truth, const Quat& estimate) {
    return rotation_vector(truth * estimate.conjugate());
}

Quat shortest_rotation(const Vec3& from, const Vec3& to) {
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

Mat3 cross_matrix(const Vec3& v) {
    Mat3 m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

Mat3 mean_rotation(const Vec3& v) {
    const Mat3 k = cross_matrix(v), k2 = k * k;
    return Mat3::Identity() + k / 2 + k2 / 6 + k2 * k / 24 + k2 * k2 / 120;
}

} // namespace bris

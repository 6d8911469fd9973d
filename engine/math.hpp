#pragma once

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace bris {

// unaligned, because their size and alignment must not depend on the instruction set
using Vec3 = Eigen::Matrix<double, 3, 1, Eigen::DontAlign>;
using Mat3 = Eigen::Matrix<double, 3, 3, Eigen::DontAlign>;
using Quat = Eigen::Quaternion<double, Eigen::DontAlign>;

inline constexpr double pi = std::numbers::pi;

/// sin(h) / h and cos(h) as functions of x = h², for h up to 1/4, where eight terms reach 1e-16.
/// Horner's rule with reciprocals that are compile-time constants: divisions would take most of a
/// step. `Number`: double or Lane.
template <class Number>
Number sinc_of_square(const Number& x) {
    return 1.0 -
           x * (1.0 / 6) *
               (1.0 -
                x * (1.0 / 20) *
                    (1.0 - x * (1.0 / 42) *
                               (1.0 - x * (1.0 / 72) *
                                          (1.0 - x * (1.0 / 110) * (1.0 - x * (1.0 / 156))))));
}
template <class Number>
Number cosine_of_square(const Number& x) {
    return 1.0 -
           x * (1.0 / 2) *
               (1.0 - x * (1.0 / 12) *
                          (1.0 - x * (1.0 / 30) *
                                     (1.0 - x * (1.0 / 56) *
                                                (1.0 - x * (1.0 / 90) * (1.0 - x * (1.0 / 132))))));
}

/// Unit quaternion of the rotation vector `v` (rad). Uses only IEEE operations (a Taylor series for
/// a halved angle, then repeated squaring), so every machine gives the same bits. Error below
/// 1e-15.
inline Quat exponential_map(const Vec3& v) {
    Vec3 half = 0.5 * v;
    int squarings = 0;
    while (half.squaredNorm() > 1.0 / 16.0) {
        half *= 0.5;
        ++squarings;
    }
    const double x = half.squaredNorm(), sinc = sinc_of_square(x);
    Quat q(cosine_of_square(x), sinc * half.x(), sinc * half.y(), sinc * half.z());
    for (; squarings > 0; --squarings) q = q * q;
    return q;
}

} // namespace bris

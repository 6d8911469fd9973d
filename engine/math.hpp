#pragma once

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace bris {

// unaligned: their size and alignment must not depend on the instruction set
using Vec3 = Eigen::Matrix<double, 3, 1, Eigen::DontAlign>;
using Mat3 = Eigen::Matrix<double, 3, 3, Eigen::DontAlign>;
using Quat = Eigen::Quaternion<double, Eigen::DontAlign>;

inline constexpr double pi = std::numbers::pi;

/// Unit quaternion of the rotation vector `v` (rad). Uses only IEEE operations (a Taylor series on
/// a halved angle, then squaring), so every machine gives the same bits; error below 1e-15.
inline Quat exponential_map(const Vec3& v) {
    // after k halvings the half-angle is at most 1/4, where eight terms reach 1e-16
    Vec3 half = 0.5 * v;
    int squarings = 0;
    while (half.squaredNorm() > 1.0 / 16.0) {
        half *= 0.5;
        ++squarings;
    }
    const double x = half.squaredNorm();
    if (x < 1e-5) { // the usual case of a quasi-static run; the next terms are below 2e-16
        const double sinc = 1 - x * (1.0 / 6) * (1 - x * (1.0 / 20)), cosine = 1 - x * 0.5 * (1 - x * (1.0 / 12) * (1 - x * (1.0 / 30)));
        return {cosine, sinc * half.x(), sinc * half.y(), sinc * half.z()};
    }
    // Horner's rule with reciprocals known to the compiler: divisions would take most of a step
    const double sinc =
        1 - x * (1.0 / 6) * (1 - x * (1.0 / 20) * (1 - x * (1.0 / 42) * (1 - x * (1.0 / 72) *
        (1 - x * (1.0 / 110) * (1 - x * (1.0 / 156))))));
    const double cosine =
        1 - x * (1.0 / 2) * (1 - x * (1.0 / 12) * (1 - x * (1.0 / 30) * (1 - x * (1.0 / 56) *
        (1 - x * (1.0 / 90) * (1 - x * (1.0 / 132))))));
    Quat q(cosine, sinc * half.x(), sinc * half.y(), sinc * half.z());
    for (; squarings > 0; --squarings) q = q * q;
    return q;
}

} // namespace bris

#pragma once

#include "engine/math.hpp"

#include <array>
#include <cmath>
#include <cstddef>

namespace bris {

using Mat6 = Eigen::Matrix<double, 6, 6>;

/// Symmetric matrix: xx, yy, zz, xy, xz, yz.
using Symmetric = std::array<double, 6>;

/// Upper bound of the largest eigenvalue, from the mean of all three and their scatter; exact where
/// the other two are equal.
inline double bound_of_eigenvalue(const Symmetric& m) {
    const double mean = (m[0] + m[1] + m[2]) / 3, x = m[0] - mean, y = m[1] - mean, z = m[2] - mean;
    const double scatter = x * x + y * y + z * z + 2 * (m[3] * m[3] + m[4] * m[4] + m[5] * m[5]);
    return mean + std::sqrt(2.0 / 3 * scatter);
}

inline Symmetric upper_part(const Mat3& m) {
    return {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2)};
}

/// Stiffness (or damping) matrix of a body for translation and rotation: the sum of those of its
/// contacts. A contact point moves by (1, -X) of them, where X = arm x (m, from the centre of
/// mass), and its stiffness is shear 1 + (normal - shear) d d' (N/m, or N s/m), where d is the
/// direction of the normal; `rolling`: N m/rad.
class BodyMatrix {
public:
    void add(const Vec3& arm, const Vec3& direction, double normal, double shear, double rolling) {
        const Vec3 d = (normal - shear) * direction, s = shear * arm;
        add_product(along_, d, direction, shear);
        add_product(turning_, -s, arm, s.dot(arm) + rolling);
        shear_at_ += s;
        const Vec3 lever = arm.cross(direction);
        if (lever.squaredNorm() <= 1e-20 * arm.squaredNorm()) return; // through the centre of mass
        add_product(turning_, (normal - shear) * lever, lever, 0);
        levered_ += d * lever.transpose();
    }
    /// Upper bound of the largest eigenvalue of M^-1/2 K M^-1/2, from those of its blocks: of a
    /// sphere, whose normals pass through its centre, and of a clump, of which `root` is the square
    /// root of the inverse moment of inertia.
    double bound(double mass, double inertia) const {
        const double both = shear_at_.norm() + levered_.norm();
        return bound_of_blocks(bound_of_eigenvalue(along_) / mass,
                               bound_of_eigenvalue(turning_) / inertia,
                               both * both / (mass * inertia));
    }
    double bound(double mass, const Mat3& root) const {
        const Mat3 both = coupled() * root;
        return bound_of_blocks(bound_of_eigenvalue(along_) / mass,
                               bound_of_eigenvalue(upper_part(root * turning() * root)),
                               bound_of_eigenvalue(upper_part(both * both.transpose())) / mass);
    }
    Mat6 matrix() const {
        Mat6 m;
        m << full(along_), coupled(), coupled().transpose(), full(turning_);
        return m;
    }

private:
    /// Adds u v', which is symmetric, and a number to its diagonal.
    static void add_product(Symmetric& sum, const Vec3& u, const Vec3& v, double to_diagonal) {
        sum[0] += u.x() * v.x() + to_diagonal;
        sum[1] += u.y() * v.y() + to_diagonal;
        sum[2] += u.z() * v.z() + to_diagonal;
        sum[3] += u.x() * v.y(), sum[4] += u.x() * v.z(), sum[5] += u.y() * v.z();
    }
    static Mat3 full(const Symmetric& s) {
        return (Mat3() << s[0], s[3], s[4], s[3], s[1], s[5], s[4], s[5], s[2]).finished();
    }
    static double bound_of_blocks(double along, double turning, double both2) {
        const double half = 0.5 * (along - turning);
        return 0.5 * (along + turning) + std::sqrt(half * half + both2);
    }
    Mat3 turning() const { return full(turning_); }
    /// Block of translation and rotation: less shear X, and what normals beside the centre add.
    Mat3 coupled() const {
        const Vec3& s = shear_at_;
        return levered_ +
               (Mat3() << 0, s.z(), -s.y(), -s.z(), 0, s.x(), s.y(), -s.x(), 0).finished();
    }
    Symmetric along_{}, turning_{};
    Vec3 shear_at_ = Vec3::Zero(); ///< N
    Mat3 levered_ = Mat3::Zero();  ///< N
};

} // namespace bris

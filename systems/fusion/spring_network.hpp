#pragma once

#include "engine/math.hpp"

#include <cstdint>
#include <vector>

namespace bris {

/// Shift (m) and rotation (rad) of a body, or force (N) and torque (N m) on it.
using Vector6 = Eigen::Matrix<double, 6, 1, Eigen::DontAlign>;

/// Number that denotes anything that stays where it is.
inline constexpr std::uint32_t that_stays = ~std::uint32_t{0};

/// Springs between a point of a body and the same point of another body, or of something that
/// stays.
struct Joint {
    std::uint32_t body, other; ///< numbers of the bodies; other < body, or `that_stays`
    Vec3 arm, other_arm;       ///< m, from the centres of the bodies to the point
    Vec3 normal;
    double kn, ks; ///< N/m, normal and tangential
};

/// Springs that hold a body at a wanted displacement.
struct Hold {
    /// N/m and N m/rad, along and about each axis. Must be > 0, because the body may have no other
    /// springs.
    Vector6 stiffness;
    Vector6 wanted = Vector6::Zero(); ///< m and rad
};

/// Bodies and the springs between them.
struct SpringNetwork {
    std::vector<Hold> holds; ///< one per body
    /// By ascending number of `body`; joints between the same two bodies should be adjacent.
    std::vector<Joint> joints;
};

/// Shifts and rotations of all bodies for which joints and holds together store the least energy.
/// `tolerance`: remaining error relative to the distance of the solution from the start, in which
/// all bodies are at their wanted displacements, both in the square root of that energy. Throws
/// SimulationError if there is no solution because stiffnesses are not positive or not finite.
std::vector<Vector6> motion_of_least_energy(const SpringNetwork& network, double tolerance);

/// Energy (J) that the joints store after a motion.
double energy_of_joints(const SpringNetwork& network, const std::vector<Vector6>& motion);

} // namespace bris

#pragma once

#include "engine/math.hpp"

#include <cstdint>
#include <vector>

namespace bris {

/// Of a body: shift (m) and turn (rad), or what goes with them, force (N) and torque (N m).
using Vector6 = Eigen::Matrix<double, 6, 1, Eigen::DontAlign>;

/// Number of what stays where it is.
inline constexpr std::uint32_t that_stays = ~std::uint32_t{0};

/// Springs between a point of a body and the same point of another, or of something that stays.
struct Joint {
    std::uint32_t body, other; ///< by their numbers; the other's is lower, or `that_stays`
    Vec3 arm, other_arm;       ///< m, from their centres to the point
    Vec3 normal;
    double kn, ks; ///< N/m, along the normal and across
};

/// Springs that hold a body where it is wanted.
struct Hold {
    Vector6 stiffness; ///< N/m and N m/rad, along and about each axis; > 0: there may be no other
                       ///< springs
    Vector6 wanted = Vector6::Zero(); ///< m and rad
};

/// Bodies and the springs between them.
struct SpringNetwork {
    std::vector<Hold> holds; ///< of each body
    std::vector<Joint>
        joints; ///< by ascending number of `body`; those between the same two should stand together
};

/// How all bodies move (shift and turn) such that joints and holds together store the least energy.
/// `tolerance`: of what is missing, relative to the way there from all bodies being where they are
/// wanted, both measured by the root of that energy. Throws SimulationError if there is no such
/// motion: stiffnesses are not positive, or not finite.
std::vector<Vector6> motion_of_least_energy(const SpringNetwork& network, double tolerance);

/// What joints store after a motion, J.
double energy_of_joints(const SpringNetwork& network, const std::vector<Vector6>& motion);

} // namespace bris

#pragma once

#include "engine/estimation/kalman.hpp"

namespace bris {

/// The fusion algorithm exactly as printed in the SmartRock report (Huang 2019, steps 3 to 6), for
/// comparison. A COV A without a transpose is not a covariance; cov times q, starting at 0, stays
/// 0, and so does the gain of the rotation.
struct PrintedFilter {
    Matrix A, Q, R; ///< 6 x 6, displacement and velocity
    Matrix q, r;    ///< 3 x 3, angular velocity
    Matrix COV = Matrix::Zero(6, 6), gain = Matrix::Zero(6, 6);
    Matrix cov = Matrix::Zero(3, 3), angular_velocity_gain = Matrix::Zero(3, 3);

    /// The fused displacement and velocity, from those of the simulation and the measured ones.
    Vector fuse(const Vector& simulated, const Vector& measured);
    /// The fused angular velocity. The report prints no update for it; this is the one that follows
    /// from its other equations.
    Vector fuse_angular_velocity(const Vector& simulated, const Vector& measured);
};

} // namespace bris

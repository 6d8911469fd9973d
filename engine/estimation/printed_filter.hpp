#pragma once

#include "engine/estimation/kalman.hpp"

namespace bris {

/// The fusion algorithm letter by letter as printed in the report (Huang 2019, steps 3 to 6), for
/// comparison. A COV A without a transpose is no covariance; cov times q, begun at 0, is 0 for
/// ever, and so is the gain of rotation.
struct PrintedFilter {
    Matrix A, Q, R; ///< 6 x 6, of displacement and velocity
    Matrix q, r;    ///< 3 x 3, of spin
    Matrix COV = Matrix::Zero(6, 6), gain = Matrix::Zero(6, 6);
    Matrix cov = Matrix::Zero(3, 3), angular_velocity_gain = Matrix::Zero(3, 3);

    /// From what the simulation says of displacement and velocity, and what was measured, to what
    /// is fused.
    Vector fuse(const Vector& simulated, const Vector& measured);
    /// Likewise of spin. The report prints no update; it would be this one.
    Vector fuse_angular_velocity(const Vector& simulated, const Vector& measured);
};

} // namespace bris

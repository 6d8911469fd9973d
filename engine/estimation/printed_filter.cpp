#include "engine/estimation/printed_filter.hpp"

#include <Eigen/LU>

namespace bris {

Vector PrintedFilter::fuse(const Vector& simulated, const Vector& measured) {
    COV = A * COV * A + Q;
    gain = COV * (COV + R).inverse(); // H is the identity
    const Vector fused = simulated + gain * (measured - simulated);
    COV -= gain * COV;
    return fused;
}

Vector PrintedFilter::fuse_angular_velocity(const Vector& simulated, const Vector& measured) {
    cov = cov * q;
    angular_velocity_gain = cov * (cov + r).inverse();
    return simulated + angular_velocity_gain * (measured - simulated);
}

} // namespace bris

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

Vector PrintedFilter::fuse_spin(const Vector& simulated, const Vector& measured) {
    cov = cov * q;
    spin_gain = cov * (cov + r).inverse();
    return simulated + spin_gain * (measured - simulated);
}

} // namespace bris

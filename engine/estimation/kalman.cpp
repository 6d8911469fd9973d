#include "engine/estimation/kalman.hpp"

#include "engine/estimation/kalman_templates.hpp"

namespace bris {

BRIS_KALMAN_OF(double);

double squared_distance(const Gaussian& estimate, const Vector& x) {
    const Vector error = x - estimate.mean;
    return estimate.root.triangularView<Eigen::Lower>().solve(error).squaredNorm();
}

} // namespace bris

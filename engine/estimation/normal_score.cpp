#include "engine/estimation/normal_score.hpp"

#include <cmath>
#include <numbers>

namespace bris {

double normal_probability(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

double normal_crps(double error, double deviation) {
    const double z = error / deviation,
                 density = std::exp(-z * z / 2) * std::numbers::inv_sqrtpi / std::numbers::sqrt2;
    return deviation *
           (z * (2 * normal_probability(z) - 1) + 2 * density - std::numbers::inv_sqrtpi);
}

} // namespace bris

#include "engine/estimation/moderated_variance.hpp"

#include <boost/math/special_functions/digamma.hpp>
#include <boost/math/special_functions/trigamma.hpp>

#include <algorithm>
#include <cmath>

namespace bris {

std::vector<double> moderated_variances(std::vector<double> variances, double freedom) {
    double n = 0, mean = 0, squares = 0; // of the logarithms
    for (const double v : variances) {
        if (!(v > 0)) continue;
        const double deviation = std::log(v) - mean;
        mean += deviation / ++n;
        squares += deviation * (std::log(v) - mean);
    }
    if (n < 4) return variances;
    // bias of the logarithm of a mean square
    const double low = boost::math::digamma(freedom / 2) - std::log(freedom / 2);
    const double kept = std::max(0.0, 1 - (n - 3) * boost::math::trigamma(freedom / 2) / squares);
    for (double& v : variances)
        if (v > 0) v = std::exp(mean - low + kept * (std::log(v) - mean));
    return variances;
}

} // namespace bris

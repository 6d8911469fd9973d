#include "engine/estimation/pooled_variance.hpp"

#include <boost/math/special_functions/digamma.hpp>
#include <boost/math/special_functions/polygamma.hpp>
#include <boost/math/special_functions/trigamma.hpp>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

/// The x > 0 whose trigamma function is y > 0, by Newton's method on its inverse (Smyth 2004,
/// appendix).
double inverse_trigamma(double y) {
    double x = 0.5 + 1 / y;
    for (int k = 0; k < 50; ++k) {
        const double t = boost::math::trigamma(x),
                     step = t * (1 - t / y) / boost::math::polygamma(2, x);
        x += step;
        if (-step < 1e-9 * x) break;
    }
    return x;
}

double bias_of_logarithm(double degrees) {
    return boost::math::digamma(degrees / 2) - std::log(degrees / 2);
}

} // namespace

std::vector<EstimatedVariance> pooled_variances(std::vector<EstimatedVariance> estimated,
                                                double most) {
    double n = 0, mean = 0, squares = 0, expected = 0, degrees = 0;
    for (const EstimatedVariance& e : estimated) {
        if (!(e.variance > 0)) continue;
        const double z = std::log(e.variance) - bias_of_logarithm(e.degrees), deviation = z - mean;
        mean += deviation / ++n;
        squares += deviation * (z - mean);
        expected += boost::math::trigamma(e.degrees / 2);
        degrees += e.degrees;
    }
    if (n < 2) return estimated;
    const double excess = squares / (n - 1) - expected / n;
    double common = most; // d0
    if (excess > 1e-6) common = std::min(most, 2 * inverse_trigamma(excess));
    const double centre = std::exp(mean + bias_of_logarithm(common));
    for (EstimatedVariance& e : estimated) {
        if (!(e.variance > 0)) continue;
        const double others = std::min(common, degrees - e.degrees); // no more than there is
        e = {(others * centre + e.degrees * e.variance) / (others + e.degrees), others + e.degrees};
    }
    return estimated;
}

} // namespace bris

#include "engine/estimation/chi_squared.hpp"

#include "engine/errors.hpp"

#include <boost/math/distributions/chi_squared.hpp>

namespace bris {

double chi_squared_quantile(double probability, double degrees) {
    require(probability > 0 && probability < 1 && degrees > 0,
            "chi square: expected a probability within 0 and 1, and degrees above 0");
    return quantile(boost::math::chi_squared(degrees), probability);
}

Band chi_squared_band(double probability, int degrees, int count) {
    const double tail = 0.5 * (1 - probability), n = count;
    return {chi_squared_quantile(tail, n * degrees) / n,
            chi_squared_quantile(1 - tail, n * degrees) / n};
}

} // namespace bris

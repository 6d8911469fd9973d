#include "engine/estimation/chi_squared.hpp"

#include "engine/errors.hpp"

#include <boost/math/distributions/chi_squared.hpp>

namespace bris {

double chi_squared_quantile(double probability, double degrees) {
    require(probability > 0 && probability < 1 && degrees > 0,
            "chi-squared: expected a probability between 0 and 1 and degrees of freedom above 0");
    return quantile(boost::math::chi_squared(degrees), probability);
}

Band chi_squared_band(double probability, int degrees, int count) {
    const double tail = 0.5 * (1 - probability), n = count;
    return {chi_squared_quantile(tail, n * degrees) / n,
            chi_squared_quantile(1 - tail, n * degrees) / n};
}

} // namespace bris

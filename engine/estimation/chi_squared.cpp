#include "engine/estimation/chi_squared.hpp"

#include "engine/errors.hpp"

#include <boost/math/distributions/chi_squared.hpp>

namespace bris {

double chi_squared_quantile(double probability, double degrees) {
    require(probability > 0 && probability < 1 && degrees > 0,
            "chi-squared: expected a probability between 0 and 1 and degrees of freedom above 0");
    return quantile(boost::math::chi_squared(degrees), probability);
}

} // namespace bris

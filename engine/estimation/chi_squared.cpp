#include "engine/estimation/chi_squared.hpp"

#include "engine/errors.hpp"

#include <boost/math/distributions/chi_squared.hpp>

namespace bris {

double chi_squared_quantile(double probability, double degrees) {
    require(probability > 0 && probability < 1 && degrees > 0,
            "chi square: expected a probability within 0 and 1, and degrees above 0");
    return quantile(boost::math::chi_squared(degrees), probability);
}

} // namespace bris

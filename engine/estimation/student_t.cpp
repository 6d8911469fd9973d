#include "engine/estimation/student_t.hpp"

#include "engine/errors.hpp"

#include <boost/math/distributions/students_t.hpp>

namespace bris {

double student_t_quantile(double probability, double degrees) {
    require(probability > 0 && probability < 1 && degrees > 0,
            "Student's t: expected a probability between 0 and 1 and degrees of freedom above 0");
    return quantile(boost::math::students_t(degrees), probability);
}

double student_t_probability(double t, double degrees) {
    require(degrees > 0, "Student's t: expected degrees of freedom above 0");
    return cdf(boost::math::students_t(degrees), t);
}

} // namespace bris

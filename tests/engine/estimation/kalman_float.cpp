// The filter in single precision, which serves the tests of rounding only.
#include "engine/estimation/kalman_templates.hpp"

namespace bris {

BRIS_KALMAN_OF(float);

} // namespace bris

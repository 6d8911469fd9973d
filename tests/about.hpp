#pragma once

#include <doctest/doctest.h>

namespace bris {

/// Equal to a number other than 0 within a relative error: about(3.3e-5).epsilon(1e-3). doctest's
/// own Approx adds the scale 1 to the size of the numbers, so that all small numbers are equal.
inline doctest::Approx about(double number) { return doctest::Approx(number).scale(0); }

} // namespace bris

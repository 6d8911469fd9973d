#pragma once

#include <doctest/doctest.h>

namespace bris {

/// Equal to a number, not 0, to a relative error: about(3.3e-5).epsilon(1e-3). doctest's own adds
/// the scale 1 to the size of the numbers, so that all small ones are alike.
inline doctest::Approx about(double number) { return doctest::Approx(number).scale(0); }

} // namespace bris

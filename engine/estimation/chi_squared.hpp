#pragma once

namespace bris {

/// The value that a sum of `degrees` squared standard normal numbers stays below with a probability
/// in (0, 1).
double chi_squared_quantile(double probability, double degrees);

} // namespace bris

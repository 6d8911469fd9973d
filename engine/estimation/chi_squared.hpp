#pragma once

namespace bris {

/// Quantile of the chi-squared distribution with `degrees` degrees of freedom (> 0) for a
/// probability in (0, 1). Throws InputError outside these ranges.
double chi_squared_quantile(double probability, double degrees);

} // namespace bris

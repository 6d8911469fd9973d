#pragma once

namespace bris {

/// Quantile of Student's t distribution with `degrees` degrees of freedom (> 0) for a probability
/// in (0, 1). Throws InputError outside these ranges.
double student_t_quantile(double probability, double degrees);

} // namespace bris

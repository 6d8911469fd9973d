#pragma once

namespace bris {

/// Quantile of Student's t distribution with `degrees` degrees of freedom (> 0) for a probability
/// in (0, 1). Throws InputError outside these ranges.
double student_t_quantile(double probability, double degrees);

/// Probability that a variable with this distribution is below t. Throws InputError unless
/// `degrees` > 0.
double student_t_probability(double t, double degrees);

} // namespace bris

#pragma once

#include <span>

namespace bris {

/// A predictive distribution: `centre` plus `scale` times a variable with Student's t distribution.
struct Predictive {
    double centre = 0, scale = 1;
    double degrees = 1; ///< of freedom
    double probability_above(double value) const;
    /// The value that is not exceeded with a probability in (0, 1).
    double quantile(double probability) const;
};

/// A new value of the population of which `values` are independent samples: their mean, and their
/// variance times 1 + 1/n, with n - 1 degrees of freedom. Throws InputError for fewer than 3
/// values, or if all are the same.
Predictive predict_by_mean(std::span<const double> values);

/// A new y at x by a line fitted to points by least squares, with the variance s^2 (1 + h) at
/// leverage h and n - 2 degrees of freedom (Seber and Lee 2003, Linear Regression Analysis, section
/// 5.3). x was measured with an error of this standard deviation; the measurement and the points'
/// own mean and variance of x are combined before it is inserted, and what remains of its variance
/// is added, times the squared slope. Throws InputError for fewer than 4 points, or if all have the
/// same x.
Predictive predict_by_line(std::span<const double> x, std::span<const double> y, double measured,
                           double deviation);

} // namespace bris

#pragma once

namespace bris {

/// Quantile of the chi-squared distribution with `degrees` degrees of freedom (> 0) for a
/// probability in (0, 1). Throws InputError outside these ranges.
double chi_squared_quantile(double probability, double degrees);

/// Interval that contains the mean of `count` independent chi-squared variables, each with
/// `degrees` degrees of freedom, with the given probability (the tails are equal).
struct Band {
    double low, high;
    bool holds(double x) const { return x >= low && x <= high; }
};
Band chi_squared_band(double probability, int degrees, int count);

} // namespace bris

#pragma once

namespace bris {

/// The value that a sum of `degrees` squared standard normal numbers stays below with a probability
/// in (0, 1).
double chi_squared_quantile(double probability, double degrees);

/// Within which the mean of `count` such sums lies with the probability.
struct Band {
    double low, high;
    bool holds(double x) const { return x >= low && x <= high; }
};
Band chi_squared_band(double probability, int degrees, int count);

} // namespace bris

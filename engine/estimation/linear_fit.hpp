#pragma once

#include <span>

namespace bris {

/// A straight line fitted to points by least squares.
struct LinearFit {
    double slope = 0, intercept = 0;
    double slope_error = 0; ///< standard error, for independent residuals
    std::size_t points = 0;
};

/// Fits a line to the points with x in [low, high]. Throws InputError if there are fewer than
/// three, or if all have the same x.
LinearFit fit_line(std::span<const double> x, std::span<const double> y, double low, double high);

} // namespace bris

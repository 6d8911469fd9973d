#pragma once

#include <span>

namespace bris {

/// A straight line through points by least squares.
struct LinearFit {
    double slope = 0, intercept = 0;
    double slope_error = 0; ///< standard error, as if the residuals were independent
    std::size_t points = 0;
};

/// Through the points whose x lies in [low, high]. Throws InputError if there are fewer than three
/// of them.
LinearFit fit_line(std::span<const double> x, std::span<const double> y, double low, double high);

} // namespace bris

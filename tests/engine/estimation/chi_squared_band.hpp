#pragma once

#include "engine/estimation/chi_squared.hpp"

namespace bris::testing {

/// An interval of chi-squared statistics.
struct Band {
    double low, high;
    bool holds(double x) const { return x >= low && x <= high; }
};

/// The interval that holds, with `probability`, the mean of `count` chi-squared variables of so
/// many degrees of freedom.
inline Band chi_squared_band(double probability, int degrees, int count) {
    const double tail = 0.5 * (1 - probability), n = count;
    return {chi_squared_quantile(tail, n * degrees) / n,
            chi_squared_quantile(1 - tail, n * degrees) / n};
}

} // namespace bris::testing

#include "engine/estimation/linear_fit.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

#include <cmath>

namespace bris {

LinearFit fit_line(std::span<const double> x, std::span<const double> y, double low, double high) {
    const auto chosen = [&](std::size_t i) { return x[i] >= low && x[i] <= high; };
    const auto over = [&](auto&& term) {
        double sum = 0;
        for (std::size_t i = 0; i < x.size(); ++i)
            if (chosen(i)) sum += term(i);
        return sum;
    };
    LinearFit fit;
    const double n = over([](std::size_t) { return 1.0; });
    if (!(n >= 3))
        throw InputError(
            fmt::format("line fit: expected at least 3 points between {:g} and {:g}, found {:g}",
                        low, high, n));
    fit.points = static_cast<std::size_t>(n);
    // about the means, so that no digits are lost in a narrow window far from zero
    const double mean_x = over([&](std::size_t i) { return x[i]; }) / n,
                 mean_y = over([&](std::size_t i) { return y[i]; }) / n;
    const double sxx = over([&](std::size_t i) { return (x[i] - mean_x) * (x[i] - mean_x); });
    if (!(sxx > 0)) throw InputError("line fit: expected points with different x, found equal x");
    fit.slope = over([&](std::size_t i) { return (x[i] - mean_x) * (y[i] - mean_y); }) / sxx;
    fit.intercept = mean_y - fit.slope * mean_x;
    const double residual_sum = over([&](std::size_t i) {
        const double r = y[i] - mean_y - fit.slope * (x[i] - mean_x);
        return r * r;
    });
    fit.slope_error = std::sqrt(residual_sum / ((n - 2) * sxx));
    return fit;
}

} // namespace bris

#include "engine/errors.hpp"
#include "engine/estimation/linear_fit.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

using namespace bris;

TEST_SUITE("engine/estimation/linear_fit") {
    TEST_CASE(
        "a line is fitted within its window only, with the standard error of a hand calculation") {
        // residuals +1 -1 -1 +1 about y = 3 + 2 x are orthogonal to 1 and x, so the fit is exact;
        // sum of squares 4, sxx = 5: standard error sqrt(4 / 2 / 5)
        const std::array x{0.0, 1.0, 2.0, 3.0, 4.0}, y{4.0, 4.0, 6.0, 10.0, 1e6};
        const LinearFit fit = fit_line(x, y, 0, 3.5);
        CHECK(fit.points == 4);
        CHECK(fit.slope == about(2).epsilon(1e-14));
        CHECK(fit.intercept == about(3).epsilon(1e-14));
        CHECK(fit.slope_error == about(std::sqrt(0.4)).epsilon(1e-14));
        CHECK_THROWS_AS(fit_line(x, y, 2.5, 4.5), InputError);
    }
}

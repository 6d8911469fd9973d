#include "engine/estimation/normal_score.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>

using namespace bris;

TEST_SUITE("estimation/normal_score") {
    TEST_CASE("the score of a normal forecast is the integral of the squared difference of "
              "distribution functions") {
        for (const double deviation : {0.3, 1.0, 4.0})
            for (const double error : {-2.0, 0.0, 0.5, 7.0}) {
                // of (P(x) - [x >= error])^2 by the midpoint rule, error of order step^2
                const double step = 1e-3, range = 10 * deviation + std::abs(error);
                double integral = 0;
                for (double x = -range + step / 2; x < range; x += step)
                    integral +=
                        step *
                        std::pow(normal_probability(x / deviation) - (x >= error ? 1 : 0), 2);
                CHECK(normal_crps(error, deviation) == about(integral).epsilon(2e-3));
            }
    }
}

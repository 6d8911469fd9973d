#include "engine/errors.hpp"
#include "engine/estimation/predictive.hpp"
#include "engine/random.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

using namespace bris;

TEST_SUITE("engine/estimation/predictive") {
    TEST_CASE("the band of a new value about the mean of a sample is Student's") {
        // t of 0.95 with 4 degrees of freedom: 2.131847 (NIST/SEMATECH e-Handbook, 1.3.6.7.2)
        const std::vector<double> values{1, 2, 3, 4, 5};
        const Predictive p = predict_by_mean(values);
        CHECK(p.centre == about(3));
        CHECK(p.degrees == 4);
        CHECK(p.quantile(0.95) - p.centre == about(2.131847 * std::sqrt(2.5 * 1.2)).epsilon(1e-6));
        CHECK(p.probability_above(p.quantile(0.95)) == about(0.05).epsilon(1e-9));
        CHECK(p.probability_above(3) == about(0.5));
    }

    TEST_CASE("the band of a new value about a line is the textbook's") {
        // y = 1 + 2 x + residuals (1, -1, -1, 1) / 10, which are orthogonal to 1 and x
        const std::vector<double> x{0, 1, 2, 3}, y{1.1, 2.9, 4.9, 7.1};
        const Predictive p = predict_by_line(x, y, 4, 0);
        const double variance = 0.04 / 2 * (1 + 0.25 + 2.5 * 2.5 / 5);
        CHECK(p.centre == about(9));
        CHECK(p.degrees == 2);
        CHECK(p.scale == about(std::sqrt(variance)).epsilon(1e-12));
    }

    TEST_CASE("an error of the measured x moves the prediction to the mean and widens it") {
        const std::vector<double> x{0, 1, 2, 3}, y{1.1, 2.9, 4.9, 7.1};
        const double prior = 5.0 / 3; // variance of x
        const Predictive p = predict_by_line(x, y, 4, std::sqrt(prior));
        CHECK(p.centre == about(1 + 2 * (1.5 + 0.5 * 2.5)).epsilon(1e-12));
        CHECK(p.scale * p.scale > 4 * 0.5 * prior);
        const Predictive nothing = predict_by_line(x, y, 4, 1e6);
        CHECK(nothing.centre == about(4).epsilon(1e-9));
    }

    TEST_CASE("90 % bands from 16 points contain 90 % of new values, also with errors of x") {
        Random random(7, 1);
        for (const double error : {0.0, 0.5}) {
            constexpr int trials = 20'000;
            int inside = 0;
            for (int trial = 0; trial < trials; ++trial) {
                std::vector<double> x(16), y(16);
                for (std::size_t k = 0; k < x.size(); ++k) {
                    x[k] = random.normal();
                    y[k] = 1 + 0.8 * x[k] + 0.3 * random.normal();
                }
                const double at = random.normal(), found = 1 + 0.8 * at + 0.3 * random.normal(),
                             measured = at + error * random.normal();
                const Predictive p = predict_by_line(x, y, measured, error);
                inside += found > p.quantile(0.05) && found < p.quantile(0.95) ? 1 : 0;
            }
            // three standard errors of the count are 0.6 %
            CHECK(std::abs(inside / double(trials) - 0.9) < (error > 0 ? 0.012 : 0.007));
        }
    }

    TEST_CASE("too few or useless points are refused") {
        const std::vector<double> two{1, 2}, same{1, 1, 1, 1}, rising{1, 2, 3, 4};
        CHECK_THROWS_AS(predict_by_mean(two), InputError);
        CHECK_THROWS_AS(predict_by_mean(same), InputError);
        CHECK_THROWS_AS(predict_by_line(two, two, 0, 0), InputError);
        CHECK_THROWS_AS(predict_by_line(same, rising, 0, 0), InputError);
    }
}

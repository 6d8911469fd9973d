#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "tests/detection.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

using namespace bris;

TEST_SUITE("engine/detection") {
    TEST_CASE("the interval of a share is that of Clopper and Pearson") {
        // 0 of n: 1 - (alpha / 2)^(1 / n); 10 of 20: published tables
        const ConfidenceInterval none = binomial_interval(0, 20);
        CHECK(none.low == 0);
        CHECK(none.high == doctest::Approx(1 - std::pow(0.025, 1.0 / 20)).epsilon(1e-12));
        const ConfidenceInterval half = binomial_interval(10, 20);
        CHECK(half.low == doctest::Approx(0.2720).epsilon(2e-4));
        CHECK(half.high == doctest::Approx(0.7280).epsilon(2e-4));
        CHECK(binomial_interval(20, 20).high == 1);
        CHECK_THROWS_AS((void)binomial_interval(3, 2), InputError);
        CHECK_THROWS_AS((void)binomial_interval(0, 0), InputError);
    }

    TEST_CASE("the area under the characteristic counts the pairs in order, ties by half") {
        const std::vector<double> low{1, 2, 3}, high{2, 4};
        // pairs (changed, unchanged): 2 > 1, 2 = 2, 4 > 1, 2, 3: 4.5 of 6
        CHECK(area_under_roc(low, high) == doctest::Approx(0.75));
        CHECK(area_under_roc(high, low) == doctest::Approx(0.25));
        const auto curve = roc_curve(low, high);
        double area = 0, x = 0, y = 0; // trapezia of the curve
        for (const RocPoint& p : curve) {
            area += (p.false_alarms - x) * (p.detections + y) / 2;
            x = p.false_alarms;
            y = p.detections;
        }
        CHECK(area == doctest::Approx(0.75));
        CHECK(curve.front().false_alarms == 0);
        CHECK(curve.back().detections == 1);
    }

    TEST_CASE("the bootstrap interval contains the area of two normal distributions") {
        // means one deviation apart: area = Phi(1 / sqrt 2) = 0.7602
        int inside = 0;
        for (unsigned trial = 0; trial < 100; ++trial) {
            Random random(31, trial);
            std::vector<double> a, b;
            for (int k = 0; k < 60; ++k) {
                a.push_back(random.normal());
                b.push_back(random.normal() + 1);
            }
            const ConfidenceInterval i = bootstrap_area_under_roc(a, b, 0.95, 300, trial);
            inside += i.low < 0.7602 && 0.7602 < i.high;
        }
        CHECK(inside >= 88); // of 95 expected; three standard deviations are 6.5
    }

    TEST_CASE("scores that are none are refused") {
        const std::vector<double> none, one{1}, nan{std::numeric_limits<double>::quiet_NaN()};
        CHECK_THROWS_AS((void)area_under_roc(none, one), InputError);
        CHECK_THROWS_AS((void)roc_curve(one, nan), InputError);
        CHECK_THROWS_AS((void)bootstrap_area_under_roc(one, one, 0.95, 0, 1), InputError);
    }
}

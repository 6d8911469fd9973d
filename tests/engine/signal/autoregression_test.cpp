#include "engine/errors.hpp"
#include "engine/math.hpp"
#include "engine/signal/autoregression.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

using namespace bris;

namespace {

/// Luteinising hormone in blood samples, dataset lh of R (Diggle 1990).
const std::vector<double> lh{2.4, 2.4, 2.4, 2.2, 2.1, 1.5, 2.3, 2.3, 2.5, 2.0, 1.9, 1.7,
                             2.2, 1.8, 3.2, 3.2, 2.7, 2.2, 2.2, 1.9, 1.9, 1.8, 2.7, 3.0,
                             2.3, 2.0, 2.0, 2.9, 2.9, 2.7, 2.7, 2.3, 2.6, 2.4, 1.8, 1.7,
                             1.5, 1.4, 2.1, 3.3, 3.5, 3.5, 3.1, 2.6, 2.1, 3.4, 3.0, 2.9};

/// Lynx trapped in Canada from 1821 to 1934, dataset lynx of R (Campbell and Walker 1977).
const std::vector<double> lynx{
    269,  321,  585,  871,  1475, 2821, 3928, 5943, 4950, 2577, 523,  98,   184,  279,  409,
    2285, 2685, 3409, 1824, 409,  151,  45,   68,   213,  546,  1033, 2129, 2536, 957,  361,
    377,  225,  360,  731,  1638, 2725, 2871, 2119, 684,  299,  236,  245,  552,  1623, 3311,
    6721, 4254, 687,  255,  473,  358,  784,  1594, 1676, 2251, 1426, 756,  299,  201,  229,
    469,  736,  2042, 2811, 4431, 2511, 389,  73,   39,   49,   59,   188,  377,  1292, 4031,
    3495, 587,  105,  153,  387,  758,  1307, 3465, 6991, 6313, 3794, 1836, 345,  382,  808,
    1388, 2713, 3800, 3091, 2985, 3790, 674,  81,   80,   108,  229,  399,  1132, 2432, 3574,
    2935, 1537, 529,  485,  662,  1000, 1590, 2657, 3396};

Runs one(const std::vector<double>& series) { return {&series, 1}; }

void check_coefficients(const ArModel& model, const std::vector<double>& expected, double error) {
    REQUIRE(model.order() == expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
        CHECK(std::abs(model.coefficients[i] - expected[i]) < error);
}

const ArModel resonance{.coefficients = {1.5, -0.9}, .variance = 1};

std::vector<double> series_of(const ArModel& model, std::size_t n, std::uint64_t seed) {
    ArSeries process(model, seed, 0);
    std::vector<double> x(n);
    for (double& value : x) value = process.next();
    return x;
}

} // namespace

TEST_SUITE("engine/signal/autoregression") {
    TEST_CASE("models of the hormone series are those that R publishes") {
        // help page of ar() of R: to every printed digit
        const ArModel yw = yule_walker(one(lh), 3).back();
        check_coefficients(yw, {0.6534016786916393, -0.06362083608746197, -0.2269402016502413},
                           1e-12);
        CHECK(yw.variance * 48 / (48 - 3 - 1) ==
              doctest::Approx(0.19586709410861838).epsilon(1e-12));
        const ArModel by_burg = burg(one(lh), 3).back();
        check_coefficients(by_burg,
                           {0.6587911429685489, -0.06080725744988141, -0.22337331994329843}, 1e-12);
        CHECK(by_burg.variance == doctest::Approx(0.17864648983245682).epsilon(1e-12));
        const ArModel ols = least_squares_ar(one(lh), 1);
        check_coefficients(ols, {0.585986971670959}, 1e-12);
        CHECK(ols.variance == doctest::Approx(0.2016452600669789).epsilon(1e-12));
        const double mean = std::accumulate(lh.begin(), lh.end(), 0.0) / 48;
        CHECK((ols.mean - mean) * (1 - ols.coefficients[0]) ==
              doctest::Approx(0.006233903953946418).epsilon(1e-9)); // the intercept
    }

    TEST_CASE("R's criterion chooses the order 3 for the hormone series by Yule and Walker") {
        const auto choice = choose_order(yule_walker(one(lh), 16), lh.size());
        CHECK(choice.by_aic == 3); // help page of ar()
        CHECK(choice.by_bic == 1); // the heavier penalty ln 48 = 3.9 per coefficient
    }

    TEST_CASE("models of the lynx series are the published ones") {
        std::vector<double> x;
        for (const double n : lynx) x.push_back(std::log10(n));
        REQUIRE(x.size() == 114);
        CHECK(std::abs(yule_walker(one(x), 0).front().mean - 2.9036638) < 6e-8);
        check_coefficients(least_squares_ar(one(x), 2), {1.384238, -0.747776}, 6e-7);
        check_coefficients(yule_walker(one(x), 2).back(), {1.350438, -0.720031}, 6e-7);
    }

    TEST_CASE("a model has the variance, the autocorrelations and the peak of its process") {
        const auto c = autocovariances_of(resonance, 5);
        CHECK(c[0] == doctest::Approx(13.970588235294121).epsilon(1e-12));
        CHECK(c[1] / c[0] == doctest::Approx(0.7894736842105263).epsilon(1e-12));
        CHECK(c[2] / c[0] == doctest::Approx(0.2842105263157896).epsilon(1e-12));
        CHECK(density_of(resonance, 0.1, 1) ==
              doctest::Approx(2 * 413.7598367831555 / 2).epsilon(1e-12));
        double peak = 0;
        for (double f = 0; f < 0.5; f += 1e-6)
            if (density_of(resonance, f, 1) > density_of(resonance, peak, 1)) peak = f;
        CHECK(peak == doctest::Approx(0.10460683890613297).epsilon(1e-5));
        double integral = 0; // periodic: the trapezium rule is exact to rounding
        for (int k = 0; k < 4000; ++k) integral += density_of(resonance, 0.5 * (k + 0.5) / 4000, 1);
        CHECK(integral * 0.5 / 4000 == doctest::Approx(c[0]).epsilon(1e-12));
    }

    TEST_CASE("the order and the coefficients of a process are found from its series") {
        const auto x = series_of(resonance, 20000, 3);
        const std::vector<std::vector<double>> runs{
            {x.begin(), x.begin() + 5000},
            {x.begin() + 5000, x.begin() + 5010}, // too short to help
            {x.begin() + 5010, x.end()}};
        for (const auto& models : {burg(runs, 20), yule_walker(runs, 20), burg(one(x), 20)}) {
            const auto choice = choose_order(models, x.size());
            CHECK(choice.by_bic == 2);
            CHECK(choice.by_aic >= 2);
            // standard deviation of a coefficient sqrt((1 - 0.81) / 20000) = 0.003
            check_coefficients(models[2], {1.5, -0.9}, 0.012);
            CHECK(models[2].variance == doctest::Approx(1).epsilon(0.04));
        }
    }

    TEST_CASE("residuals of the true model are its innovations, and uncorrelated") {
        const auto x = series_of({.mean = 2, .coefficients = {0.5}, .variance = 4}, 40000, 1);
        const auto e = residuals_of({.mean = 2, .coefficients = {0.5}, .variance = 4}, x);
        REQUIRE(e.size() == x.size() - 1);
        CHECK(e[10] == doctest::Approx(x[11] - 2 - 0.5 * (x[10] - 2)));
        const auto rho = autocorrelations(one(e), 10);
        for (std::size_t k = 1; k <= 10; ++k) CHECK(std::abs(rho[k]) < 4 / std::sqrt(4e4));
        const auto of_series = autocorrelations(one(x), 4);
        CHECK(of_series[1] == doctest::Approx(0.5).epsilon(0.05));
        // 1 + 2 (0.8 / 2 + 0.6 / 4 + 0.4 / 8 + 0.2 / 16)
        CHECK(variance_factor_of_mean(std::vector{1.0, 0.5, 0.25, 0.125, 0.0625}, 5) ==
              doctest::Approx(2.225).epsilon(1e-14));
    }

    TEST_CASE("series that give no model are refused") {
        const std::vector<double> constant(50, 3.0), three{1, 2, 4};
        CHECK_THROWS_AS((void)burg(one(constant), 2), InputError);
        CHECK_THROWS_AS((void)yule_walker(one(constant), 2), InputError);
        CHECK_THROWS_AS((void)burg(one(three), 3), InputError);
        CHECK_THROWS_AS((void)least_squares_ar(one(three), 1), InputError);
        CHECK(residuals_of(resonance, three).size() == 1);
        CHECK(residuals_of(resonance, std::vector{1.0}).empty());
    }
}

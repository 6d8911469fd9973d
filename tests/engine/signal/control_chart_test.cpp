#include "engine/errors.hpp"
#include "engine/signal/autoregression.hpp"
#include "engine/signal/control_chart.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <functional>

using namespace bris;

namespace {

/// n, c4, d2, d3, A2, A3, B3, B4, D3, D4; independent quadrature with scipy, which agrees with the
/// tables of Montgomery in all their digits.
constexpr std::array<std::array<double, 10>, 6> published{
    {{2, 0.79788456, 1.12837917, 0.85250, 1.879971, 2.658681, 0, 3.266532, 0, 3.26654},
     {3, 0.88622693, 1.69256875, 0.88837, 1.023327, 1.954410, 0, 2.568170, 0, 2.57459},
     {5, 0.93998560, 2.32592895, 0.86408, 0.576819, 1.427299, 0, 2.088998, 0, 2.11450},
     {7, 0.95936879, 2.70435675, 0.83321, 0.419284, 1.181916, 0.117685, 1.882315, 0.07571, 1.92429},
     {10, 0.97265927, 3.07750546, 0.79705, 0.308264, 0.975350, 0.283706, 1.716294, 0.22302,
      1.77698},
     {25, 0.98964038, 3.93062922, 0.70844, 0.152647, 0.606281, 0.564786, 1.435214, 0.45929,
      1.54071}}};

/// Mean number of points up to the first signal, over `runs` runs. `make_point` returns the next
/// point's function for a run; `signals`: whether a point is a signal.
template <class MakeRun>
double mean_run_length(std::size_t runs, MakeRun&& make_run) {
    double points = 0;
    for (std::size_t run = 0; run < runs; ++run) {
        auto next_is_signal = make_run(run);
        do ++points;
        while (!next_is_signal());
    }
    return points / static_cast<double>(runs);
}

const ArModel half{.coefficients = {0.5}, .variance = 0.75}; // AR(1) of variance 1

/// Subgroups of five successive samples of the process, one subgroup independent of the other.
auto separate_subgroups(const ControlChart& chart, std::uint64_t seed) {
    return [&chart, seed](std::size_t run) {
        return [&chart, random = Random(seed, run)]() mutable {
            double x = random.normal(), sum = x;
            for (int k = 1; k < 5; ++k) sum += x = 0.5 * x + std::sqrt(0.75) * random.normal();
            return chart.is_outlier(sum / 5);
        };
    };
}

std::vector<double> baseline_of(const ArModel& model, std::size_t n) {
    ArSeries process(model, 77, 0);
    std::vector<double> x(n);
    for (double& value : x) value = process.next();
    return x;
}

} // namespace

TEST_SUITE("engine/signal/control_chart") {
    TEST_CASE("the constants are those of published tables") {
        for (const auto& row : published) {
            const ChartConstants c = chart_constants(static_cast<std::size_t>(row[0]));
            CAPTURE(row[0]);
            CHECK(c.c4 == doctest::Approx(row[1]).epsilon(1e-8));
            CHECK(c.d2 == doctest::Approx(row[2]).epsilon(1e-8));
            CHECK(std::abs(c.d3 - row[3]) < 1e-5);
            const std::array factors{c.A2, c.A3, c.B3, c.B4};
            for (std::size_t k = 0; k < 4; ++k) CHECK(std::abs(factors[k] - row[4 + k]) < 6e-7);
            CHECK(std::abs(c.D3 - row[8]) < 2e-5);
            CHECK(std::abs(c.D4 - row[9]) < 2e-5);
        }
        CHECK_THROWS_AS((void)chart_constants(1), InputError);
    }

    TEST_CASE("limits for independent values give 22 subgroups to a false alarm where successive "
              "values are correlated, corrected limits give 370") {
        // subgroups of 5 of an AR(1) process with 0.5: the variance of a mean is 2.225 times that
        // of independent values, three-sigma limits are 2.011 sigma, 1 / P(|z| > 2.011) = 22.6
        const auto x = baseline_of(half, 400'000);
        const ControlChart naive = mean_chart(Runs(&x, 1), 5, 3, ControlLimits::independent),
                           corrected = mean_chart(Runs(&x, 1), 5, 3, ControlLimits::corrected);
        CHECK(naive.deviation == doctest::Approx(std::sqrt(0.2)).epsilon(0.01));
        CHECK(corrected.deviation == doctest::Approx(std::sqrt(0.2 * 2.225)).epsilon(0.01));
        const double by_naive = mean_run_length(20'000, separate_subgroups(naive, 1)),
                     by_corrected = mean_run_length(10'000, separate_subgroups(corrected, 2));
        MESSAGE("in-control run lengths: " << by_naive << " and " << by_corrected);
        CHECK(std::abs(by_naive - 22) < 2);
        CHECK(std::abs(by_corrected / 370 - 1) < 0.15);
    }

    TEST_CASE("a chart of the residuals of the model has the run length of independent values") {
        const auto x = baseline_of(half, 400'000);
        const auto model = burg(Runs(&x, 1), 1).back();
        const auto e = residuals_of(model, x);
        const ControlChart chart = mean_chart(Runs(&e, 1), 5, 3, ControlLimits::independent);
        const double length = mean_run_length(10'000, [&](std::size_t run) {
            return [&, process = ArSeries(half, 5, run, 20), last = 0.0]() mutable {
                double sum = 0; // the chart goes on along one series
                for (int k = 0; k < 5; ++k) {
                    const double now = process.next();
                    sum += now - model.mean - model.coefficients[0] * (last - model.mean);
                    last = now;
                }
                return chart.is_outlier(sum / 5);
            };
        });
        CHECK(std::abs(length / 370 - 1) < 0.15);
    }

    TEST_CASE("subgroups do not reach across a gap between runs") {
        const std::vector<std::vector<double>> runs{{1, 3, 100}, {5, 9}, {7}};
        CHECK(subgroup_means(runs, 2) == std::vector{2.0, 7.0});
        const auto s = subgroup_deviations(runs, 2);
        CHECK(s[0] == doctest::Approx(std::sqrt(2.0)));
        CHECK(s[1] == doctest::Approx(std::sqrt(8.0)));
    }

    TEST_CASE("twice the vibration is outside the limits of the deviation of subgroups") {
        const auto x = baseline_of({.variance = 1}, 100'000);
        const ControlChart chart = deviation_chart(Runs(&x, 1), 20, 3);
        CHECK(chart.centre == doctest::Approx(std::log(chart_constants(20).c4)).epsilon(0.2));
        std::size_t inside = 0, outside = 0;
        for (const double s : subgroup_deviations(Runs(&x, 1), 20)) {
            inside += chart.is_outlier(std::log(s));
            outside += chart.is_outlier(std::log(2 * s));
        }
        CHECK(inside < 50);    // of 5000
        CHECK(outside > 4200); // a shift of ln 2 by 4.2 deviations of 0.165: 88 %
    }

    TEST_CASE("a baseline that is too short or constant gives no chart") {
        const std::vector<double> constant(100, 2.0), few{1, 2};
        CHECK_THROWS_AS((void)mean_chart(Runs(&constant, 1), 5, 3, ControlLimits::corrected),
                        InputError);
        CHECK_THROWS_AS((void)deviation_chart(Runs(&constant, 1), 5, 3), InputError);
        CHECK_THROWS_AS((void)mean_chart(Runs(&few, 1), 5, 3, ControlLimits::independent),
                        InputError);
    }
}

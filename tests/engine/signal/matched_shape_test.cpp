#include "engine/errors.hpp"
#include "engine/math.hpp"
#include "engine/random.hpp"
#include "engine/signal/matched_shape.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

namespace {

constexpr double rate = 200; // Hz

/// A wave that swells and fades: exp(-((t - 10) / 3)^2) sin(2 pi f t).
double wave(double t, double f) {
    return std::exp(-std::pow((t - 10) / 3, 2)) * std::sin(2 * pi * f * t);
}

std::vector<double> samples_of_wave(double f) {
    std::vector<double> x;
    for (int k = 0; k < 4000; ++k) x.push_back(wave(k / rate, f));
    return x;
}

} // namespace

TEST_SUITE("engine/signal/matched_shape") {
    TEST_CASE("waves above the lowest frequency pass, and those below half of it do not") {
        for (const double f : {2.0, 5.0, 20.0}) {
            const auto x = samples_of_wave(f), y = without_slow_part(x, rate, 1);
            REQUIRE(y.size() == x.size());
            for (std::size_t k = 0; k < x.size(); ++k) CHECK(std::abs(y[k] - x[k]) < 1e-5);
        }
        for (const double y : without_slow_part(samples_of_wave(1), rate, 4))
            CHECK(std::abs(y) < 5e-6);
    }

    TEST_CASE("two derivatives are those of the wave") {
        const double f = 3, h = 1e-3;
        const auto y = without_slow_part(samples_of_wave(f), rate, 1, 2);
        for (std::size_t k = 400; k + 400 < y.size(); ++k) { // the ends are steps
            const double t = static_cast<double>(k) / rate;
            const double second = (-wave(t - 2 * h, f) + 16 * wave(t - h, f) - 30 * wave(t, f) +
                                   16 * wave(t + h, f) - wave(t + 2 * h, f)) /
                                  (12 * h * h);
            CHECK(std::abs(y[k] - second) < 1e-4 * std::pow(2 * pi * f, 2));
        }
    }

    TEST_CASE("a shape is found where it lies, and its factor scatters as its deviation says, in "
              "white noise and in noise of low frequencies") {
        const auto shape = samples_of_wave(2);
        Random random(4, 1);
        for (const double memory : {0.0, 0.95}) {
            double squares = 0;
            constexpr int trials = 200;
            for (int trial = 0; trial < trials; ++trial) {
                const long lag = trial % 11 - 5;
                std::vector<double> series(shape.size());
                double noise = 0;
                for (std::size_t k = 0; k < series.size(); ++k) {
                    noise = memory * noise + 0.3 * random.normal();
                    const long from = static_cast<long>(k) - lag;
                    series[k] = noise + 0.5 * wave(static_cast<double>(from) / rate, 2);
                }
                const MatchedShape m = match_shape(series, shape, 10);
                CHECK(std::abs(m.lag - lag) <= (memory > 0 ? 15 : 3));
                squares += std::pow((m.factor - 0.5) / m.deviation, 2);
            }
            CAPTURE(memory);
            CHECK(std::sqrt(squares / trials) == about(1.0).epsilon(0.25));
        }
    }

    TEST_CASE("what cannot be matched is refused") {
        const std::vector<double> two(2), zero(10, 0.0), some{1, 2, 3, 4};
        CHECK_THROWS_AS(without_slow_part(two, rate, 1), InputError);
        CHECK_THROWS_AS(without_slow_part(some, 1.5, 1), InputError);
        CHECK_THROWS_AS(without_slow_part(some, rate, 1, 1), InputError);
        CHECK_THROWS_AS(match_shape(some, zero, 1), InputError);
        CHECK_THROWS_AS(match_shape(two, some, 1), InputError);
    }
}

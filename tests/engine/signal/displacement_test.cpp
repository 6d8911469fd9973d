#include "engine/errors.hpp"
#include "engine/math.hpp"
#include "engine/random.hpp"
#include "engine/signal/displacement.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

namespace {

constexpr double rate = 200; // Hz

/// A wave of 1 mm that swells and fades: exp(-((t - 10) / 3)^2) sin(2 pi f t).
double wave(double t, double f) {
    return 1e-3 * std::exp(-std::pow((t - 10) / 3, 2)) * std::sin(2 * pi * f * t);
}

std::vector<double> acceleration_of_wave(double f) {
    constexpr double h = 1e-3;
    std::vector<double> a;
    for (int k = 0; k < 4000; ++k) {
        const double t = k / rate;
        a.push_back((-wave(t - 2 * h, f) + 16 * wave(t - h, f) - 30 * wave(t, f) +
                     16 * wave(t + h, f) - wave(t + 2 * h, f)) /
                    (12 * h * h));
    }
    return a;
}

} // namespace

TEST_SUITE("engine/signal/displacement") {
    TEST_CASE("a wave above the lowest frequency comes back, with bias and drift removed") {
        for (const double f : {1.5, 5.0, 20.0}) {
            auto a = acceleration_of_wave(f);
            for (std::size_t k = 0; k < a.size(); ++k)
                a[k] += 0.05 + 1e-3 * static_cast<double>(k) / rate;
            const auto u = displacement_of(a, rate, 1);
            REQUIRE(u.size() == a.size());
            double worst = 0;
            for (std::size_t k = 0; k < u.size(); ++k)
                worst = std::max(worst, std::abs(u[k] - wave(static_cast<double>(k) / rate, f)));
            CAPTURE(f);
            CHECK(worst < 2e-6);
        }
    }

    TEST_CASE("a wave below half the lowest frequency is lost") {
        for (const double u : displacement_of(acceleration_of_wave(1), rate, 4))
            CHECK(std::abs(u) < 1e-6);
    }

    TEST_CASE("the noise of the displacement is what its density says") {
        const double noise = 1e-3;
        Random random(3, 1);
        for (const double lowest : {0.5, 2.0}) {
            double squares = 0, count = 0;
            for (int trial = 0; trial < 60; ++trial) {
                std::vector<double> a(8000);
                for (double& x : a) x = noise * std::sqrt(rate) * random.normal();
                const auto u = displacement_of(a, rate, lowest);
                for (std::size_t k = 2000; k < 6000; ++k, ++count) squares += u[k] * u[k];
            }
            CAPTURE(lowest);
            CHECK(std::sqrt(squares / count) ==
                  about(displacement_noise(noise, lowest)).epsilon(0.08));
        }
    }

    TEST_CASE("the largest fall is that between turns") {
        CHECK(largest_fall(std::vector<double>{0, 1, 0.5, 2, -1, 0}, 0.1) == 3);
        CHECK(largest_fall(std::vector<double>{0, -1, -0.95, -2, 0}, 0.1) == 2); // a small rise
        CHECK(largest_fall(std::vector<double>{0, -1, -0.5, -2, 0}, 0.1) == 1.5);
        CHECK(largest_fall(std::vector<double>{0, 1, 2}, 0.1) == 0);
        CHECK(largest_fall(std::vector<double>{}, 0.1) == 0);
    }

    TEST_CASE("series that cannot be integrated are refused") {
        const std::vector<double> two(2), many(100);
        CHECK_THROWS_AS(displacement_of(two, rate, 1), InputError);
        CHECK_THROWS_AS(displacement_of(many, 1.5, 1), InputError);
        CHECK_THROWS_AS(displacement_of(many, rate, 0), InputError);
    }
}

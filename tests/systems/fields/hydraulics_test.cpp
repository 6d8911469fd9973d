#include "systems/fields/hydraulics.hpp"

#include <doctest/doctest.h>

#include <initializer_list>

using namespace bris;

TEST_SUITE("fields/hydraulics") {
    TEST_CASE("Kozeny-Carman gives the published values of ballast, far beyond its validity") {
        // rho g / mu n^3 d^2 / (180 (1 - n)^2) by hand for n = 0.42, d = 20 mm and water at 20 C
        const double by_hand = 998.2 * 9.81 / 1e-3 * 0.074088 * 4e-4 / (180 * 0.3364);
        CHECK(kozeny_carman(0.42, 0.02) == doctest::Approx(by_hand));
        CHECK(kozeny_carman(0.42, 0.02) == doctest::Approx(4.80).epsilon(2e-3));
        CHECK(reynolds_number(kozeny_carman(0.42, 0.02), 0.02) > 9e4);
        CHECK(reynolds_number(kozeny_carman(0.45, 1e-4), 1e-4) < 1); // fines: valid
    }

    TEST_CASE("Forchheimer's equation holds, and is that of Darcy for slow flow") {
        for (const double i : {1e-9, 1e-3, 0.1, 1.0, 10.0}) {
            const double n = 0.42, d = 0.03, q = filter_velocity(n, d, i);
            const double b = 1.75 * (1 - n) / (9.81 * n * n * n * d);
            CHECK(q / kozeny_carman(n, d) + b * q * q == doctest::Approx(i));
        }
        CHECK(filter_velocity(0.42, 1e-4, 1) ==
              doctest::Approx(kozeny_carman(0.42, 1e-4)).epsilon(0.01));
        // clean ballast: tenths of a metre per second, not metres
        CHECK(filter_velocity(0.42, 0.03, 1) > 0.1);
        CHECK(filter_velocity(0.42, 0.03, 1) < 0.5);
    }

    TEST_CASE("the conductivity of fouled ballast is that of the published formula") {
        // kb = 0.3 m/s, kf = 1e-4 m/s, VCI = 26.169 %: harmonic mean, by hand
        CHECK(fouled_conductivity(0.3, 1e-4, 0.26169) ==
              doctest::Approx(0.3 * 1e-4 / (1e-4 + 0.26169 * (0.3 - 1e-4))));
        CHECK(fouled_conductivity(0.3, 1e-4, 0.26169) == doctest::Approx(3.8177e-4).epsilon(1e-4));
        CHECK(fouled_conductivity(0.3, 1e-4, 0) == 0.3);
        CHECK(fouled_conductivity(0.3, 1e-4, 1) == doctest::Approx(1e-4));
    }
}

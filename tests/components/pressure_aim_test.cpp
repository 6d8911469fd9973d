#include "components/pressure_aim.hpp"

#include <doctest/doctest.h>

using namespace bris;

TEST_SUITE("components/pressure_aim") {
    TEST_CASE("the first target is taken at once, and held to the bit while it does not change") {
        PressureAim aim;
        for (int k = 0; k < 10; ++k) CHECK(aim.next(55e3) == 55e3);
    }

    TEST_CASE("a new target is reached without haste or return, and then held to the bit") {
        for (const double target : {80e3, 0.0}) {
            PressureAim aim;
            const double start = aim.next(50e3);
            double before = start, largest = 0;
            for (int k = 0; k + 1 < PressureAim::ramp_steps; ++k) {
                const double now = aim.next(target);
                CHECK((now - before) * (target - start) > 0);
                largest = std::max(largest, std::abs(now - before));
                before = now;
            }
            CHECK(before != target);
            // the steepest of half a cosine is pi / 2 of the mean
            CHECK(largest <= 0.5 * pi * std::abs(target - start) / PressureAim::ramp_steps);
            CHECK(std::abs(target - before) <
                  1e-3 * std::abs(target - start)); // arrives gently: (pi / ramp)^2 / 4
            for (int k = 0; k < 3; ++k) CHECK(aim.next(target) == target);
        }
    }

    TEST_CASE("a target that changes on the way is aimed at from where the aim stands") {
        PressureAim aim;
        aim.next(1e4);
        double now = 0;
        for (int k = 0; k < 50; ++k) now = aim.next(2e4);
        const double turned = aim.next(1e4);
        CHECK(std::abs(turned - now) < 1e-3 * 1e4);
        for (int k = 0; k < PressureAim::ramp_steps; ++k) now = aim.next(1e4);
        CHECK(now == 1e4);
    }
}

#include "components/pressure_aim.hpp"

#include <doctest/doctest.h>

using namespace bris;

TEST_SUITE("components/pressure_aim") {
    TEST_CASE("the set point takes the first target at once and keeps its bits while the target "
              "does not change") {
        PressureAim aim;
        for (int k = 0; k < 10; ++k) CHECK(aim.next(55e3) == 55e3);
    }

    TEST_CASE("the set point approaches a new target monotonically with a bounded rate, and then "
              "keeps its bits") {
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
            // the largest slope of half a cosine is pi / 2 times the mean slope
            CHECK(largest <= 0.5 * pi * std::abs(target - start) / PressureAim::ramp_steps);
            CHECK(std::abs(target - before) <
                  1e-3 * std::abs(target - start)); // last step: (pi / ramp)^2 / 4
            for (int k = 0; k < 3; ++k) CHECK(aim.next(target) == target);
        }
    }

    TEST_CASE(
        "when the target changes during the ramp, the new ramp starts from the present set point") {
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

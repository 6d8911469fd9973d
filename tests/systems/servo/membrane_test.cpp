#include "systems/servo/membrane.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

using namespace bris;

TEST_SUITE("servo/membrane") {
    TEST_CASE("a wall that meets more contacts becomes heavier and keeps its momentum") {
        double stiffness = 1e5;
        ServoMotion servo{stiffness, 0, 1, 1e-5};
        CHECK(servo.next(0.01, 0, 2.5e5) == about(0.004).epsilon(1e-12));
        CHECK(stiffness == 2.5e5);
        // it does not become lighter when it loses them
        CHECK(servo.next(0.01, 0, 1e5) == about(0.01).epsilon(1e-12));
        CHECK(stiffness == 2.5e5);
    }

    TEST_CASE("local damping weakens a force that drives a wall and strengthens one that brakes "
              "it") {
        double stiffness = 1e5;
        const double dt = 1e-5, force = 20, mass = stiffness * dt * dt / 0.81;
        ServoMotion servo{stiffness, 0.7, 1, dt};
        const double kick = force / mass * dt, fast = 10 * kick;
        CHECK(servo.next(fast, force, 0) - fast == about(0.3 * kick).epsilon(1e-9));
        CHECK(servo.next(-fast, force, 0) + fast == about(1.7 * kick).epsilon(1e-9));
        CHECK(servo.next(fast, -force, 0) - fast == about(-1.7 * kick).epsilon(1e-9));
    }

    TEST_CASE("a wall moves no farther in a step than the largest step") {
        double stiffness = 1e5;
        ServoMotion servo{stiffness, 0.7, 1e-6, 1e-5};
        CHECK(servo.next(0, 1e9, 0) == about(0.1).epsilon(1e-12));
        CHECK(servo.next(0, -1e9, 0) == about(-0.1).epsilon(1e-12));
    }
}

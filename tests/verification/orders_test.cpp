#include "scenarios/collision/impact.hpp"
#include "tests/support.hpp"
#include "tests/verification/impacts.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::detail;
using bris::testing::order_of;

namespace {

/// Root mean square error of restitution over the phase of a step at which the contact begins.
double restitution_error(Impact s, double expected, double steps) {
    s.steps_per_contact = steps;
    double sum = 0;
    constexpr int phases = 16;
    for (int k = 0; k < phases; ++k) {
        s.phase = (k + 0.5) / phases;
        const double e = run_experiment(s).normal_restitution - expected;
        sum += e * e;
    }
    return std::sqrt(sum / phases);
}

Impact damped(LawName law, Tension tension) {
    Material m = is_hertz(law) ? elastic("Al oxide", 3.8e11, 0.23, 4000) : linear_material(1e6);
    m.restitution = 0.5;
    Impact s = on_wall(m, 0.0025, 3.9, law);
    if (!is_hertz(law)) s.partner_material = m;
    s.policy.tension = tension;
    return s;
}

// nominal restitution 0.5; 0.5503 if tension is cut (Schwager and Poeschel 2007)
constexpr std::pair<Tension, double> policies[]{
    {Tension::allowed, 0.5}, {Tension::cut, 0.55028317}, {Tension::calibrated, 0.5}};

} // namespace

TEST_SUITE("verification/orders") {
    TEST_CASE("restitution of a linear contact converges with second order in dt") {
        for (const auto& [tension, expected] : policies) {
            const Impact s = damped(LawName::linear_viscous, tension);
            const double coarse = restitution_error(s, expected, 50),
                         fine = restitution_error(s, expected, 200);
            MESSAGE("linear: errors ", coarse, " at t_c/50, ", fine, " at t_c/200, order ",
                    0.5 * order_of(coarse, fine));
            CHECK(0.5 * order_of(coarse, fine) > 1.8);
        }
    }

    TEST_CASE("restitution of a Hertz contact converges with second order in dt") {
        for (const auto& [tension, expected] : policies) {
            const Impact s = damped(LawName::hertz_mindlin_viscous, tension);
            const double coarse = restitution_error(s, expected, 100),
                         fine = restitution_error(s, expected, 800);
            MESSAGE("Hertz: errors ", coarse, " at t_c/100, ", fine, " at t_c/800, order ",
                    order_of(coarse, fine) / 3);
            CHECK(order_of(coarse, fine) / 3 > 1.8);
        }
    }

    TEST_CASE("the angular velocity after an oblique impact converges faster than with first order "
              "in dt") {
        Impact s = on_wall(elastic("Al oxide", 3.8e11, 0.23, 4000, 1, 0.092), 0.0025, 3.9,
                           LawName::hertz_mindlin);
        s.angle = 20 * degree;
        s.steps_per_contact = 8000;
        const double exact = run_experiment(s).angular_velocity.y();
        const auto error = [&](double steps) {
            s.steps_per_contact = steps;
            return std::abs(run_experiment(s).angular_velocity.y() / exact - 1);
        };
        const double coarse = error(100), fine = error(400);
        MESSAGE("angular velocity at 20 degrees: errors ", coarse, " at t_c/100, ", fine,
                " at t_c/400, order ", 0.5 * order_of(coarse, fine));
        CHECK(coarse < 1e-3);
        CHECK(0.5 * order_of(coarse, fine) > 1.2); // sliding begins and ends within a step
    }

    TEST_CASE("the dissipated work of an impact equals its loss of energy, and the error decreases "
              "with the step") {
        Impact s = on_wall(elastic("Al oxide", 3.8e11, 0.23, 4000, 0.7, 0.3), 0.0025, 3.9,
                           LawName::hertz_mindlin_viscous);
        s.angle = 40 * degree;
        const auto error = [&](double steps) {
            s.steps_per_contact = steps;
            return std::abs(run_experiment(s).energy_budget_error);
        };
        const double coarse = error(100), fine = error(800);
        MESSAGE("error of the energy budget: ", coarse, " at t_c/100, ", fine, " at t_c/800");
        CHECK(coarse < 1e-2);
        CHECK(fine < 1e-3);
        CHECK(fine < coarse / 4);
    }
}

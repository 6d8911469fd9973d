#include "engine/errors.hpp"
#include "scenarios/collision/impact.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "tests/about.hpp"
#include "tests/verification/cases.hpp"
#include "tests/verification/chain.hpp"
#include "tests/verification/crystal.hpp"
#include "tests/verification/impacts.hpp"
#include "tests/verification/table.hpp"
#include "tests/verification/top.hpp"

#include <doctest/doctest.h>

using namespace bris;

TEST_SUITE("verification/experiments") {
    TEST_CASE("an experiment with impossible settings is refused") {
        CHECK_THROWS_AS(run_experiment(Impact{}), InputError); // neither density nor moduli
        Impact grazing;
        grazing.law = LawName::linear;
        grazing.material = grazing.partner_material = linear_material(1e5);
        grazing.angle = 2;
        CHECK_THROWS_AS(run_experiment(grazing), InputError);
        Top top;
        top.inertia = Vec3(3, 2, 1);
        CHECK_THROWS_AS(run_experiment(top), InputError);
        top.inertia = Vec3(2, 2, 2);
        CHECK_THROWS_AS(run_experiment(top), InputError);
        top = {};
        top.angular_velocity = Vec3(0, 0, 1);
        CHECK_THROWS_AS(run_experiment(top), InputError);
        Pendulum pendulum;
        pendulum.amplitude = 1.5;
        CHECK_THROWS_AS(run_experiment(pendulum), InputError);
        ChainWave wave;
        wave.mode = 40;
        CHECK_THROWS_AS(run_experiment(wave), InputError);
        Crystal crystal;
        crystal.material.young_modulus = 5e9;
        crystal.strain = 1;
        CHECK_THROWS_AS(run_experiment(crystal), InputError);
        CHECK_THROWS_AS(verify("no such group"), InputError);
    }

    TEST_CASE("Jacobi's solution conserves energy and angular momentum and satisfies Euler's "
              "equations on both sides of the separatrix") {
        const Vec3 inertia(1, 1.7, 2.4);
        for (const Vec3& angular_velocity :
             {Vec3(0.2, 0.3, 1), Vec3(-0.4, 0.1, -0.9), Vec3(1, -0.2, 0.3), Vec3(-1, 0.3, 0.2),
              Vec3(0.8, 0.4, -0.1)}) {
            const FreeTop top(inertia, angular_velocity);
            CHECK((top.angular_velocity(0) - angular_velocity).norm() < 1e-14);
            CHECK((top.angular_velocity(top.period()) - angular_velocity).norm() < 1e-12);
            for (const double t : {0.3, 1.7, 12.0}) {
                const Vec3 w = top.angular_velocity(t), momentum = w.cwiseProduct(inertia);
                CHECK(w.dot(momentum) ==
                      about(angular_velocity.dot(angular_velocity.cwiseProduct(inertia)))
                          .epsilon(1e-13));
                CHECK(momentum.norm() ==
                      about(angular_velocity.cwiseProduct(inertia).norm()).epsilon(1e-13));
                // dL/dt = L x w; the central difference has an error of h^2/6 times the third
                // derivative plus rounding / h
                const double h = 1e-5;
                const Vec3 rate =
                    (top.angular_velocity(t + h) - top.angular_velocity(t - h)) / (2 * h);
                CHECK((rate.cwiseProduct(inertia) - momentum.cross(w)).norm() < 1e-9);
                // in the space frame the angular momentum is constant
                CHECK((top.attitude(t, 5000) * momentum - angular_velocity.cwiseProduct(inertia))
                          .norm() < 1e-11);
            }
        }
    }

    TEST_CASE("a check fails if its number is out of tolerance, NaN, or on the wrong side of a "
              "limit") {
        Checks checks("group");
        checks.relative("right", "m", 2, 2.0001, 1e-4);
        checks.relative("off", "m", 2, 2.001, 1e-4);
        checks.absolute("none", "", 0, std::nan(""), 1);
        checks.at_most("below", "", 1, 0.5);
        checks.at_most("above", "", 1, 1.5);
        checks.at_least("too little", "", 1, 0.5);
        checks.at_least("not a number", "", 1, std::nan(""));
        const auto& list = checks.list();
        CHECK(list[0].passes());
        CHECK_FALSE(list[1].passes());
        CHECK_FALSE(list[2].passes());
        CHECK(list[3].passes());
        CHECK_FALSE(list[4].passes());
        CHECK_FALSE(list[5].passes());
        CHECK_FALSE(list[6].passes());
        CHECK(names_of_failing(list) ==
              "group: off; group: none; group: above; group: too little; group: not a number");
        CHECK(csv_of(list).find("group,\"off\",\"m\",2,2.001,") != std::string::npos);
        CHECK(table_of(list).find("FAILS") != std::string::npos);
        const auto closest = closest_to_tolerance(list, 5);
        REQUIRE(closest.size() == 5);
        CHECK(closest[0].quantity == "none"); // not a number before the largest error
        CHECK(closest[4].quantity == "off");
    }
    TEST_CASE("an impact of the user's own agrees with its law in fine steps, and fails if its "
              "steps are too few") {
        Impact impact = detail::on_wall(detail::elastic("granite", 5e10, 0.25, 2650, 0.5, 0.6),
                                        0.02, 1, LawName::hertz_mindlin_viscous);
        impact.angle = 30 * detail::degree;
        impact.steps_per_contact = 200;
        for (const Check& c : verify_impact("impact", impact, 0.01))
            CHECK_MESSAGE(c.passes(), c.quantity, ": ", c.error());
        impact.steps_per_contact = 8;
        CHECK_FALSE(names_of_failing(verify_impact("impact", impact, 0.01)).empty());
    }
}

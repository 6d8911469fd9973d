#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

TEST_SUITE("physics/local_damping") {
    TEST_CASE("with local damping 0.7 a body falls at 0.3 g and rises at 1.7 g") {
        for (const double direction : {-1.0, 1.0}) {
            World world = make_world(Grains::spheres);
            const auto material = add_material(world, linear_material(1e5));
            const EntityId ball = add_sphere(world, Vec3::Zero(), 0.01, material);
            value_of<Velocity>(world, ball) = Vec3(0, 0, 3 * direction);
            world.add_resource<Gravity>();
            world.add_resource(LocalDamping{0.7});
            Simulation sim = begin(std::move(world), {.dt = 1e-4});
            sim.advance(1000);
            const double change = value_of<Velocity>(sim, ball).z() - 3 * direction;
            // 1000 additions to a speed of 3 m/s
            CHECK(std::abs(change + (direction < 0 ? 0.3 : 1.7) * 9.81 * 0.1) < 1000 * 2.2e-16 * 4);
        }
    }

    TEST_CASE("with local damping 0.7 any undamped spring rebounds at sqrt(0.3 / 1.7)") {
        const double exact = std::sqrt(0.3 / 1.7); // 0.420084
        const auto restitution = [](double steps, double phase) {
            World world = make_world(Grains::spheres);
            const auto material = add_material(world, linear_material(1e6));
            add_floor(world, material);
            const EntityId ball = add_sphere(world, Vec3::Zero(), 0.01, material);
            const double dt = pi / std::sqrt(1e6 / value_of<Mass>(world, ball)) / steps;
            value_of<Position>(world, ball) = Vec3(0, 0, 0.01 + dt * (10 - phase));
            value_of<Velocity>(world, ball) = Vec3(0, 0, -1);
            world.add_resource(LocalDamping{0.7});
            Simulation sim =
                begin(std::move(world), {.dt = dt, .law = LawName::linear_frictionless});
            sim.advance(static_cast<std::uint64_t>(3 * steps));
            return value_of<Velocity>(sim, ball).z();
        };
        double worst = 0, coarse = 0;
        for (const double phase : {0.05, 0.25, 0.5, 0.75, 0.95}) {
            worst = std::max(worst, std::abs(restitution(500, phase) - exact));
            coarse = std::max(coarse, std::abs(restitution(125, phase) - exact));
        }
        MESSAGE("local damping: error of e ", coarse, " at t_c/125 and ", worst,
                " at t_c/500, order ", order_of(coarse, worst) / 2);
        CHECK(worst < 1e-4);
    }

    TEST_CASE("local damping depends on the frame of reference, as its definition implies") {
        // the same impact in a moving frame of reference has a different rebound
        const auto rebound = [](double boost) {
            World world = make_world(Grains::spheres);
            const auto material = add_material(world, linear_material(1e6));
            const EntityId a = add_sphere(world, Vec3(0, 0, 0), 0.01, material),
                           b = add_sphere(world, Vec3(0, 0, 0.0201), 0.01, material);
            value_of<Velocity>(world, a) = Vec3(0, 0, 1 + boost);
            value_of<Velocity>(world, b) = Vec3(0, 0, -1 + boost);
            world.add_resource(LocalDamping{0.7});
            Simulation sim =
                begin(std::move(world), {.dt = 1e-6, .law = LawName::linear_frictionless});
            sim.advance(1500);
            return value_of<Velocity>(sim, b).z() - value_of<Velocity>(sim, a).z();
        };
        CHECK(rebound(0) == about(2 * std::sqrt(0.3 / 1.7)).epsilon(1e-3));
        CHECK(std::abs(rebound(10) - rebound(0)) > 0.1);
    }
}

#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

TEST_SUITE("physics/oscillator") {
    TEST_CASE("a sphere on a plane's spring follows the exact discrete leapfrog solution") {
        const double radius = 0.01, stiffness = 1e5, g = 1000; // strong gravity holds the contact
        for (const double omega_dt : {0.01, 0.3, 1.0, 1.9}) {
            World world = make_world(Grains::spheres);
            const auto material = add_material(world, linear_material(stiffness));
            add_floor(world, material);
            const EntityId ball = add_sphere(world, Vec3::Zero(), radius, material);
            const double mass = value_of<Mass>(world, ball), omega = std::sqrt(stiffness / mass),
                         dt = omega_dt / omega;
            const double rest = radius - mass * g / stiffness; // 1e-4 m of overlap
            // so small that no step can carry the sphere past the surface
            const double amplitude = 0.2 * mass * g / stiffness;
            const double omega_num = 2 / dt * std::asin(0.5 * omega_dt);
            value_of<Position>(world, ball) = Vec3(0, 0, rest + amplitude);
            // x(-dt) = A cos(-w dt): the velocity half a step earlier is the difference quotient
            value_of<Velocity>(world, ball) =
                Vec3(0, 0, amplitude * (1 - std::cos(omega_num * dt)) / dt);
            world.add_resource<Gravity>({Vec3(0, 0, -g)});
            Simulation sim =
                begin(std::move(world), {.dt = dt, .law = LawName::linear_frictionless});
            double worst = 0;
            const int steps = 1000;
            for (int n = 1; n <= steps; ++n) {
                sim.advance();
                const double exact = rest + amplitude * std::cos(omega_num * n * dt);
                worst = std::max(worst, std::abs(value_of<Position>(sim, ball).z() - exact));
            }
            CAPTURE(omega_dt);
            // each step rounds the position by eps R and the force by eps (relative to R k); near
            // the stability limit the discrete solution amplifies a disturbance by 1/sin(w_num dt)
            const double rounding = 2.2e-16 * radius * steps / std::sin(omega_num * dt);
            CHECK(worst <= 2 * rounding);
        }
    }

    TEST_CASE("the conserved quantity of the discrete oscillator does not drift") {
        const double radius = 0.01, stiffness = 1e5, g = 1000;
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, linear_material(stiffness));
        add_floor(world, material);
        const EntityId ball = add_sphere(world, Vec3::Zero(), radius, material);
        const double mass = value_of<Mass>(world, ball), omega = std::sqrt(stiffness / mass),
                     dt = 0.5 / omega;
        const double rest = radius - mass * g / stiffness, amplitude = 0.5 * mass * g / stiffness;
        value_of<Position>(world, ball) = Vec3(0, 0, rest + amplitude);
        world.add_resource<Gravity>({Vec3(0, 0, -g)});
        Simulation sim = begin(std::move(world), {.dt = dt, .law = LawName::linear_frictionless});
        const auto invariant = [&] {
            // x(t) and the mean of the velocities around t: x^2 (1 - (w dt / 2)^2) + v^2 / w^2
            const double x = value_of<Position>(sim, ball).z() - rest;
            const double next_a = -omega * omega * x,
                         v = value_of<Velocity>(sim, ball).z() + 0.5 * dt * next_a;
            return x * x * (1 - 0.25 * omega * omega * dt * dt) + v * v / (omega * omega);
        };
        sim.advance();
        const double first = invariant();
        sim.advance(20'000);
        // rounding adds at most eps R / A per step
        CHECK(std::abs(invariant() / first - 1) < 2.2e-16 * radius / amplitude * 20'000);
    }
}

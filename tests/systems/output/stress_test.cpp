#include "components/settings.hpp"
#include "systems/output/stress.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

TEST_SUITE("output/stress") {
    TEST_CASE("the stress of a column of three spheres at rest follows from their weights") {
        constexpr double radius = 0.01, kn = 1e6, g = 9.81;
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, linear_material(kn, 0, 0));
        add_floor(world, material);
        EntityId ball{};
        double mass = 0, top = 0;
        for (int k = 0; k < 3; ++k) {
            ball = add_sphere(world, Vec3::Zero(), radius, material);
            mass = value_of<Mass>(world, ball);
            // each contact carries the weight of the spheres above it
            top += (k == 0 ? 1 : 2) * radius - (3 - k) * mass * g / kn;
            value_of<Position>(world, ball) = Vec3(0, 0, top);
        }
        world.add_resource<Gravity>({Vec3(0, 0, -g)});
        Simulation sim = begin(std::move(world), {.dt = 1e-9});
        sim.advance();
        const Stresses s = compute_stresses(sim.world());
        // sum of force times branch: 3 mg on the floor, 2 mg and mg above
        const double overlap = mass * g / kn,
                     expected = mass * g *
                                (3 * (radius - 1.5 * overlap) + 2 * (2 * radius - 2 * overlap) +
                                 2 * radius - overlap);
        CHECK(s.contact.axial == about(expected).epsilon(1e-4));
        CHECK(s.boundary.axial == about(expected).epsilon(1e-4));
        CHECK(s.contact.radial == 0);
    }

    TEST_CASE("the weight of a falling sphere is not balanced by contact stress") {
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, linear_material(1e6, 0, 0));
        add_sphere(world, Vec3(0, 0, 1), 0.01, material);
        world.add_resource<Gravity>({Vec3(0, 0, -9.81)});
        Simulation sim = begin(std::move(world), {.dt = 1e-6});
        sim.advance();
        CHECK(!(compute_stresses(sim.world()).mismatch() <= 0.5));
    }
}

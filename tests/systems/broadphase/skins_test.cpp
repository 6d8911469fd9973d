#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

namespace {

constexpr double radius = 0.01;

/// A block of spheres at rest without gravity, above which one sphere flies.
World block_and_flyer(double speed) {
    World world = make_world(Grains::spheres);
    const auto material = add_material(world, linear_material(1e5));
    for (int k = 0; k < 216; ++k)
        add_sphere(world, 2.1 * radius * Vec3(k % 6, k / 6 % 6, k / 36), radius, material);
    const EntityId flyer = add_sphere(world, Vec3(-20 * radius, 0, 14 * radius), radius, material);
    value_of<Velocity>(world, flyer) = Vec3(speed, 0, 0);
    return world;
}

} // namespace

TEST_SUITE("broadphase/skins") {
    TEST_CASE("a body that flies among others at rest has larger skins than they, and lists serve "
              "longer than with equal skins") {
        constexpr double speed = 1, dt = 1e-5;
        Simulation sim = begin(block_and_flyer(speed), {.dt = dt, .law = LawName::linear});
        sim.advance(4000);
        const EntityId flyer = 216;
        CHECK(value_of<InnerSkin>(sim, flyer) > 5 * value_of<InnerSkin>(sim, 0));
        CHECK(value_of<OuterSkin>(sim, flyer) > 5 * value_of<OuterSkin>(sim, 0));
        const ListState& lists = sim.world().resource<ListState>();
        const ListSettings& settings = sim.world().resource<ListSettings>();
        // with equal skins, of half the skin of a pair, the lists would serve for so many steps
        const double equal = 0.5 * settings.inner_skin / (speed * dt);
        CHECK(4000.0 / static_cast<double>(lists.prunes) > 2 * equal);
    }

    TEST_CASE("the skins of bodies that move alike are equal, half the skin of a pair each") {
        World world = block_and_flyer(0);
        for (Vec3& v : world.column<Bodies, Velocity>()) v = Vec3(0, 0, -1);
        Simulation sim = begin(std::move(world), {.dt = 1e-5, .law = LawName::linear});
        sim.advance(2000);
        const double half = 0.5 * sim.world().resource<ListSettings>().inner_skin;
        REQUIRE(sim.world().resource<ListState>().prunes > 1);
        for (const double skin : sim.world().column<Bodies, InnerSkin>())
            CHECK(skin == about(half).epsilon(1e-6));
    }

    TEST_CASE("no point of a body that spins and flies moves farther than the lists assume") {
        World world = make_world(Grains::clumps);
        const auto material = add_material(world, linear_material(1e5));
        const EntityId body = add_clump(world, scaled(small_rock(), 0.02), 0, Vec3::Zero(),
                                        exponential_map(Vec3(0.3, 0.2, -0.4)), material);
        (void)add_clump(world, scaled(small_rock(), 0.02), 0, Vec3(0.2, 0, 0),
                        Quat(Quat::Identity()), material);
        value_of<Velocity>(world, body) = Vec3(0, 0, 0.02);
        set_angular_velocity(world, body, Vec3(0, 0, 20));
        Simulation sim = begin(std::move(world), {.dt = 1e-5});
        const double reach = value_of<BoundingRadius>(sim, body);
        int far = 0;
        for (int k = 0; k < 2000; ++k) {
            sim.advance();
            const Vec3 gone = value_of<Position>(sim, body) - value_of<PrunedAt>(sim, body);
            const double angle = value_of<Orientation>(sim, body).angularDistance(
                value_of<PrunedOrientation>(sim, body));
            const double bound = value_of<DisplacementBound>(sim, body);
            // a point of the sphere about the centre that moves along with the centre
            if (angle > 0) CHECK(bound >= gone.norm() + 2 * reach * std::sin(angle / 2) - 1e-12);
            far += angle * reach > 1e-4 ? 1 : 0;
        }
        CHECK(far > 100);
    }
}

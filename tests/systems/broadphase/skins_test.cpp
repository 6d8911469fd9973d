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
}

#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace bris;
using namespace bris::testing;

namespace {

using Partners = std::vector<std::pair<EntityId, EntityId>>;

Partners touching_now(const World& world) {
    Partners list;
    for (const TouchingPair& p : touching_pairs<SpherePairs>(world))
        list.push_back({p.names.owner, p.names.partner});
    return list;
}

} // namespace

TEST_SUITE("broadphase/sphere_pairs") {
    TEST_CASE("every touching pair of spheres of very different sizes is found once, whichever "
              "sphere has the lower id") {
        std::vector<Vec3> position;
        std::vector<double> size;
        for (unsigned k = 0; k < 600; ++k) {
            Random random(11, k);
            // most are small; sizes from 1 to 50 mm fall into four grids
            size.push_back(0.001 * std::pow(50, std::pow(random.uniform(), 4)));
            position.push_back(0.1 * Vec3(random.uniform(), random.uniform(), random.uniform()));
        }
        Partners expected;
        for (EntityId a = 0; a < position.size(); ++a)
            for (EntityId b = a + 1; b < position.size(); ++b)
                if ((position[a] - position[b]).norm() < size[a] + size[b])
                    expected.push_back({a, b});
        REQUIRE(expected.size() > 1000);
        for (const double ratio :
             {3.0, 1e9}) { // of sizes in a grid: four grids, or one grid for all
            World world = make_world(Grains::spheres);
            const auto material =
                add_material(world, linear_material(1, 0, 0)); // soft, so overlaps do not matter
            world.resource<Limits>().overlap = 1e9;
            for (std::size_t k = 0; k < position.size(); ++k)
                add_sphere(world, position[k], size[k], material);
            Simulation sim = begin(std::move(world), {.dt = 1e-9,
                                                      .law = LawName::linear_frictionless,
                                                      .lists = {.widest_ratio = ratio}});
            sim.advance();
            CHECK(touching_now(sim.world()) == expected);
        }
    }

    TEST_CASE("two fixed bodies form no pair, however deep they overlap") {
        for (const Motion second : {Motion::fixed, Motion::free}) {
            World world = make_world(Grains::spheres);
            const auto material = add_material(world, linear_material(1, 0, 0));
            world.resource<Limits>().overlap = 1e9;
            for (const double x : {0.0, 0.01}) add_sphere(world, {x, 0, 0}, 0.01, material);
            const auto motion = world.column<Bodies, MotionOf>();
            motion[0] = static_cast<std::uint32_t>(Motion::fixed);
            motion[1] = static_cast<std::uint32_t>(second);
            Simulation sim =
                begin(std::move(world), {.dt = 1e-9, .law = LawName::linear_frictionless});
            sim.advance();
            CHECK(sim.world().table<SpherePairs>().size() == (second == Motion::free ? 1 : 0));
        }
    }
}

#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace bris;
using namespace bris::testing;

namespace {

using Partners = std::vector<std::pair<EntityId, EntityId>>;

Partners touching_now(const World& world) {
    Partners list;
    for (const TouchingPair& p : touching_pairs<SpherePairs>(world)) list.push_back({p.names.owner, p.names.partner});
    return list;
}

} // namespace

TEST_SUITE("broadphase/sphere_pairs") {
    TEST_CASE(
        "of spheres of very different sizes all touching pairs are found, each once, whichever has the lower id") {
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, linear_material(1, 0, 0)); // soft: they overlap as they like
        world.resource<Limits>().overlap = 1e9;
        std::vector<Vec3> place;
        std::vector<double> size;
        for (unsigned k = 0; k < 600; ++k) {
            Random random(11, k);
            // most are small; sizes from 1 to 40 mm fall into four grids
            size.push_back(0.001 * std::pow(40, std::pow(random.uniform(), 4)));
            place.push_back(0.1 * Vec3(random.uniform(), random.uniform(), random.uniform()));
            add_sphere(world, place.back(), size.back(), material);
        }
        Partners expected;
        for (EntityId a = 0; a < place.size(); ++a)
            for (EntityId b = a + 1; b < place.size(); ++b)
                if ((place[a] - place[b]).norm() < size[a] + size[b]) expected.push_back({a, b});
        REQUIRE(expected.size() > 1000);
        Simulation sim = start(std::move(world), {.dt = 1e-9, .law = LawName::linear_frictionless});
        sim.advance();
        CHECK(touching_now(sim.world()) == expected);
    }
}

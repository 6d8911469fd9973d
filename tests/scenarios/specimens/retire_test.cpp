#include "engine/ordering.hpp"
#include "engine/state.hpp"
#include "scenarios/specimens/retire.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace bris;
using namespace bris::testing;

namespace {

constexpr EntityId first_stray = 61; // after 60 grains and the box

/// A settling bed and `strays` spheres far above it, which touch nothing for a long time. Their ids
/// are in the middle of the range.
World bed_with_strays(unsigned strays) {
    World world = bed({.bodies = 60});
    for (unsigned k = 0; k < strays; ++k)
        REQUIRE(add_sphere(world, Vec3(0.015 + 0.02 * (k % 3), 0.015 + 0.02 * (k / 3), 0.28), 0.005,
                           0) == first_stray + k);
    const World more = bed({.bodies = 10, .seed = 2});
    for (Row b = 0; b < more.table<Bodies>().size(); ++b)
        if (more.column<Bodies, MotionOf>()[b] == static_cast<std::uint32_t>(Motion::free))
            add_sphere(world, more.column<Bodies, Position>()[b] + Vec3(0, 0, 0.15),
                       more.column<Bodies, BoundingRadius>()[b], 0);
    return world;
}

std::vector<Vec3> positions(const World& world) {
    std::vector<Vec3> list;
    for (const Row b : rows_by_id(world.column<Bodies, BodyId>()))
        list.push_back(world.column<Bodies, Position>()[b]);
    return list;
}

std::vector<Row> rows_of_strays(const World& world, unsigned strays) {
    std::vector<Row> rows;
    for (unsigned k = 0; k < strays; ++k) rows.push_back(row_of_body(world, first_stray + k));
    return rows;
}

} // namespace

TEST_SUITE("specimens/retire") {
    TEST_CASE("retired bodies have no effect on the other bodies, which move with the same bits as "
              "if they had stayed") {
        const SmallSceneSettings settings{.law = LawName::linear_viscous};
        Simulation kept = begin(bed_with_strays(7), settings),
                   retired = begin(bed_with_strays(7), settings);
        kept.advance(3000);
        retired.advance(1500); // tangential springs are loaded by then
        const std::size_t before = retired.world().table<Bodies>().size();
        const auto names = retire_bodies(retired.world(), rows_of_strays(retired.world(), 7));
        retired.prepare();
        CHECK(names.removed() == 7);
        CHECK(names(first_stray + 6) == nobody);
        CHECK(names(first_stray + 7) == first_stray);
        CHECK(retired.world().table<Bodies>().size() == before - 7);
        retired.advance(1500);
        const auto all = positions(kept.world()), remainder = positions(retired.world());
        for (EntityId id = 0; id < all.size(); ++id)
            if (names(id) != nobody) CHECK(all[id] == remainder[names(id)]);
    }

    TEST_CASE(
        "a snapshot of a scene with retired bodies is restored in a scene that still had them") {
        const SmallSceneSettings settings{.law = LawName::linear_viscous};
        Simulation first = begin(bed_with_strays(3), settings),
                   second = begin(bed_with_strays(3), settings);
        first.advance(500);
        retire_bodies(first.world(), rows_of_strays(first.world(), 3));
        first.prepare();
        first.advance(100);
        second.on_restore(forget_lists);
        second.restore(first.snapshot());
        first.advance(400);
        second.advance(400);
        CHECK(fingerprint(first.snapshot()) == fingerprint(second.snapshot()));
    }
}

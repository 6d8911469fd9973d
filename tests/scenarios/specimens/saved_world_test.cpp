#include "engine/state.hpp"
#include "scenarios/specimens/saved_world.hpp"
#include "systems/fields/field_set.hpp"
#include "systems/fields/initial_fouling.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

namespace {

World tube() {
    World world = bed({.grains = Grains::clumps, .bodies = 20, .seed = 2});
    for (Vec3& x : world.column<Bodies, Position>()) x -= Vec3(0.028, 0.028, -0.003);
    const auto wall = add_material(world, {"membrane", 0, 4e5, 0, 0, 500, 0});
    add_tube(world, {.rings = 3, .sectors = 8, .radius = 0.06, .height = 0.1}, wall);
    return world;
}

} // namespace

TEST_SUITE("specimens/saved_world") {
    TEST_CASE("the fields of a saved state have the bits of those of the world itself") {
        World world = tube();
        add_fouling(world, {.voxel = 4e-3, .samples = 2});
        fill_with_fines(world, {.p4 = 8, .p200 = 2, .saturation = 0.4});
        const World saved = world_of_state(save_state(world));
        const FieldSet a = fields_of(world, {}), b = fields_of(saved, {});
        REQUIRE(a.blocks == b.blocks);
        REQUIRE(a.fields.size() == b.fields.size());
        CHECK(a.find("fouling") != nullptr);
        CHECK(a.void_volume == b.void_volume);
        for (std::size_t k = 0; k < a.fields.size(); ++k)
            for (std::size_t c = 0; c < a.fields[k].components.size(); ++c)
                for (std::uint32_t n = 0; n < a.blocks.voxels(); ++n)
                    REQUIRE(a.fields[k].components[c][n] == b.fields[k].components[c][n]);
        const FoulingMeasures m = measure_fouling(saved, present_fouling(saved));
        CHECK(m.p4 == doctest::Approx(8));
    }

    TEST_CASE("porosity is that of the voids inside the boundaries") {
        const FieldSet inside = fields_of(tube(), {.voxel = 4e-3, .samples = 3});
        CHECK(inside.void_volume > 0);
        World open = make_world(Grains::spheres);
        const auto material = add_material(open, {"rock", 2650, 1e6});
        add_sphere(open, Vec3(0.01, 0.02, 0.03), 0.01, material);
        const FieldSet alone = fields_of(open, {.voxel = 2e-3, .samples = 4});
        CHECK(alone.void_volume == 0);
        CHECK(alone.solids.value == doctest::Approx(4 * pi / 3 * 1e-6).epsilon(2e-3));
        CHECK(alone.find("fines") == nullptr);
        const auto* density = alone.find("density");
        const auto* porosity = alone.find("porosity");
        for (std::uint32_t n = 0; n < alone.blocks.voxels(); ++n)
            if (alone.shown[n] != 0)
                REQUIRE(density->components[0][n] + porosity->components[0][n] ==
                        doctest::Approx(1));
    }

    TEST_CASE("an archive without bodies is refused") {
        CHECK(refusal_of([] { (void)world_of_state(Archive{}); }) ==
              "checkpoint: expected bodies and spheres, found none");
    }
}

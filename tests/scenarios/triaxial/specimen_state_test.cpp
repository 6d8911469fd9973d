#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/membrane.hpp"
#include "components/platen.hpp"
#include "components/sphere.hpp"
#include "engine/clock.hpp"
#include "engine/errors.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/triaxial/specimen_state.hpp"
#include "scenarios/triaxial/triaxial_scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace bris;

namespace {

Triaxial small(double density = 0, double friction = -1) {
    Triaxial t;
    t.bodies = 150;
    t.least_diameter = 1;
    t.specimen.sensor_density = density;
    t.specimen.sensor_friction = friction;
    return t;
}

World world_of(const Triaxial& t) {
    const TriaxialScene s = make_scene(t, 1);
    return make_triaxial_world(s.specimen, s.clumps, s.smart_rocks, s.sample.rocks, s.poses);
}

// A specimen under a platen at 100 kPa; `largest_step` (m) of the platen limits that of sensor
// rocks.
Simulation pressed_specimen(double largest_step) {
    Simulation simulation = make_simulation(make_scene(small(), 1), 1);
    World& world = simulation.world();
    forget_lists(world);
    world.resource<Clock>().change_step(1e-6);
    world.resource<Platen>().target_pressure = 1e5;
    world.resource<Platen>().largest_step = largest_step;
    return simulation;
}

struct Frictions {
    double rock_rock, shell_rock, shell_shell, shell_platen;
};
Frictions frictions(const World& world) {
    const auto& m = world.resource<Materials>();
    const auto& s = world.resource<Specimen>();
    const auto of = [&](std::uint32_t a, std::uint32_t b) {
        return m.linear_pairs[m.pair(a, b)].friction;
    };
    return {of(s.rock_material, s.rock_material), of(s.sensor_material, s.rock_material),
            of(s.sensor_material, s.sensor_material), of(s.sensor_material, s.platen_material)};
}

} // namespace

TEST_SUITE("triaxial/specimen_state") {
    TEST_CASE(
        "sensor rocks have the material of the rocks unless they are given shells of their own") {
        World plain = world_of(small()), shells = world_of(small(1250, 0.3));
        CHECK(plain.resource<Materials>().list.size() == 3);
        CHECK(plain.resource<Specimen>().sensor_material ==
              plain.resource<Specimen>().rock_material);
        const auto& smart = shells.resource<Specimen>().smart_rocks;
        CHECK(smart == plain.resource<Specimen>().smart_rocks);
        for (const EntityId id : smart) {
            CHECK(value_of<Mass>(shells, id) ==
                  about(1250.0 / 2750 * value_of<Mass>(plain, id)).epsilon(1e-14));
            CHECK(value_of<Inertia>(shells, id)
                      .isApprox(1250.0 / 2750 * value_of<Inertia>(plain, id), 1e-14));
        }
        const EntityId rock = shells.resource<Specimen>().rocks[0];
        CHECK(value_of<Mass>(shells, rock) == value_of<Mass>(plain, rock));
        const Frictions f = frictions(shells);
        CHECK(f.rock_rock == 0.7);
        CHECK(f.shell_rock == 0.3);
        CHECK(f.shell_shell == 0.3);
        CHECK(f.shell_platen == 0.3);
    }

    TEST_CASE("shells keep their own friction coefficient when that of the rocks changes; between "
              "shell and rock the lower one acts") {
        World own = world_of(small(0, 0.3)), heavy = world_of(small(4000));
        for (const double friction : {0.0, 0.2, 0.5}) {
            set_friction(own, friction);
            set_friction(heavy, friction);
            CAPTURE(friction);
            CHECK(frictions(own).rock_rock == friction);
            CHECK(frictions(own).shell_rock == std::min(friction, 0.3));
            CHECK(frictions(own).shell_shell == 0.3);
            CHECK(frictions(heavy).shell_rock == friction);
            CHECK(frictions(heavy).shell_shell == friction);
        }
        set_rocks(own, 0.6, 2e7);
        const auto& m = own.resource<Materials>();
        const auto& s = own.resource<Specimen>();
        CHECK(frictions(own).shell_rock == 0.3);
        CHECK(m.linear_pairs[m.pair(s.sensor_material, s.rock_material)].kn ==
              1e7); // two in series
        CHECK(m.linear_pairs[m.pair(s.sensor_material, s.sensor_material)].ks == 1e7);
    }

    TEST_CASE("sensor rocks take the named shapes in turn, angular ones and cubes, all at the same "
              "sieve size") {
        Triaxial t = small();
        t.bodies = 400;
        t.sensor_shape = "rock_02, rock_02, rock_02, cube";
        const TriaxialScene scene = make_scene(t, 1);
        REQUIRE(scene.smart_rocks.size() == 4);
        World world = make_triaxial_world(scene.specimen, scene.clumps, scene.smart_rocks,
                                          scene.sample.rocks, scene.poses);
        const auto& specimen = world.resource<Specimen>();
        REQUIRE(specimen.smart_rocks.size() == 7); // cubes are wide, so there is no room for ten
        for (std::size_t k = 0; k < 7; ++k) {
            const Clump& shape = specimen.clumps[value_of<ShapeOf>(world, specimen.smart_rocks[k])];
            CAPTURE(k);
            CHECK(shape.name == (k % 4 == 3 ? "cube" : "rock_02"));
            CHECK(shape.sieve == about(t.specimen.smartrock_size).epsilon(1e-12));
            CHECK(value_of<Mass>(world, specimen.smart_rocks[k]) ==
                  about(2750 * shape.volume).epsilon(1e-14));
            CHECK(value_of<BoundingRadius>(world, specimen.smart_rocks[k]) ==
                  shape.bounding_radius);
        }
        t.sensor_shape = "rock_02,sphere";
        CHECK_THROWS_WITH_AS(make_scene(t, 1), doctest::Contains("found 'sphere'"), InputError);
    }

    TEST_CASE("a held sensor rock gives way to rocks that press on it, but stays in the mould") {
        Simulation simulation = pressed_specimen(1e-4);
        World& world = simulation.world();
        const EntityId sensor = world.resource<Specimen>().smart_rocks.back();
        const double wall = membrane_radius(world), top = platen_height(world);
        for (const Vec3& push :
             {Vec3(1, 0.3, 0), Vec3(-0.2, -1, 0), Vec3(0, 0, -1), Vec3(0, 0, 1)}) {
            const Vec3 before = value_of<Position>(world, sensor);
            double reach = 0, low = top, high = 0;
            for (int block = 0; block < 2000; ++block) {
                value_of<Force>(world, sensor) = 1e6 * push;
                lead_sensor_rocks(world, 50);
                value_of<Position>(world, sensor) +=
                    50 * 1e-6 * value_of<DriveVelocity>(world, sensor);
            }
            const auto run = value_of<SpheresOf>(world, sensor);
            for (Row k = run.first; k < run.first + run.count; ++k) {
                const Ball& ball = world.column<Spheres, LocalBall>()[k];
                const Vec3 centre = value_of<Position>(world, sensor) +
                                    value_of<Orientation>(world, sensor) * ball.centre;
                for (const Vec3& outward : world.resource<Membrane>().outward)
                    reach = std::max(reach, centre.dot(outward) + ball.radius);
                low = std::min(low, centre.z() - ball.radius);
                high = std::max(high, centre.z() + ball.radius);
            }
            CAPTURE(push.transpose());
            CHECK((value_of<Position>(world, sensor) - before).norm() > 1e-3);
            CHECK(reach < wall + 1e-4);
            CHECK(low > -1e-4);
            CHECK(high < top + 1e-4);
            CHECK(std::max({reach - wall, -low, high - top}) > -1e-4); // it has come to a side
        }
    }

    TEST_CASE("a held sensor rock comes to rest between its place and rocks that resist") {
        Simulation simulation = pressed_specimen(1e-5);
        World& world = simulation.world();
        const EntityId sensor = world.resource<Specimen>().smart_rocks.back();
        Vec3& position = value_of<Position>(world, sensor);
        const Vec3 place = position, towards = -Vec3(place.x(), place.y(), 0).normalized();
        position += 0.004 * towards;
        const double radius = value_of<BoundingRadius>(world, sensor);
        const double limit = 10 * 1e5 * pi * radius * radius; // as lead_sensor_rocks
        for (const double stiffness : {1e8, 1e9}) {
            // the rocks stand 2 mm before the place, and resist as a spring
            const auto resist = [&] {
                return std::max(0.0, stiffness * (0.002 - (position - place).dot(towards)));
            };
            double moved = 0;
            for (int block = 0; block < 600; ++block) {
                value_of<Force>(world, sensor) = resist() * towards;
                lead_sensor_rocks(world, 50, true);
                const Vec3 way = 50 * 1e-6 * value_of<DriveVelocity>(world, sensor);
                position += way;
                moved = block < 500 ? 0 : std::max(moved, way.norm());
            }
            CAPTURE(stiffness);
            CAPTURE(resist() / limit);
            // within twice the least step, which is 1 % of the largest one of 1 mm
            CHECK(moved < 2e-5);
            CHECK(resist() > 0);
            CHECK(std::abs(resist() - limit) <= 2.2e-5 * stiffness);
        }
    }
}

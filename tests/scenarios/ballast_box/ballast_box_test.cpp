#include "engine/errors.hpp"
#include "scenarios/ballast_box/box_run.hpp"
#include "scenarios/ballast_box/box_scene.hpp"
#include "scenarios/ballast_box/cycles.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/fields/vdb_file.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <numeric>
#include <span>

using namespace bris;
using namespace bris::testing;

TEST_SUITE("ballast_box") {
    TEST_CASE("table 1 has twelve runs of eight groups, and clean ones come before fouled ones") {
        std::size_t runs = 0;
        double seconds = 0;
        for (const BoxTest& test : table_1()) {
            runs += test.frequencies.size();
            for (const double f : test.frequencies) seconds += 1000 / f;
        }
        CHECK(table_1().size() == 8);
        CHECK(runs == 12);
        CHECK(seconds == about(2 * 9500)); // of 1000 cycles each
        CHECK(box_test("I.1").peak_load == 160e3);
        CHECK(box_test("II.4").peak_load == 290e3);
        CHECK_FALSE(box_test("I.4").confined);
        CHECK(refusal_of([] { (void)box_test("III.1"); }).starts_with("--run: expected a run"));
    }

    TEST_CASE("loads beyond the actuators, and fines or water that a run does not have, are "
              "refused") {
        BallastBox box;
        box.peak_load = 500e3;
        CHECK(refusal_of([&] { check_box(box); }) ==
              "--peak-load: expected at most the 490 kN of an actuator, found 500 kN");
        box.peak_load = 490e3;
        CHECK(refusal_of([&] { check_box(box); }).empty());
        box.fouling.p4 = 10;
        CHECK(refusal_of([&] { check_box(box); }) ==
              "--fouling-p4: expected none in run I.2 on clean ballast, found 10");
        box.run = "II.2";
        CHECK(refusal_of([&] { check_box(box); }).empty());
        box.fouling.saturation = 0.5;
        CHECK(refusal_of([&] { check_box(box); }) ==
              "--saturation: expected none in run II.2 on dry ballast, found 0.5");
        box.run = "II.3";
        CHECK(refusal_of([&] { check_box(box); }).empty());
        box.fouling.p4 = box.fouling.saturation = 0;
        box.fouling.file = "no_such_file.vdb";
        CHECK_THROWS_AS(check_box(box), OutputError);
    }

    TEST_CASE("the names of the runs choose fines and water: none, dry or wet") {
        BallastBox box;
        box.run = "I.3"; // wet, but clean
        CHECK_FALSE(fouling_of(box).any());
        box.run = "II.1";
        CHECK(fouling_of(box).p4 == 17);
        CHECK(fouling_of(box).p200 == 3);
        CHECK(fouling_of(box).saturation == 0);
        box.run = "II.4";
        CHECK(fouling_of(box).saturation == 0.9);
        box.fouling.p4 = 5;
        CHECK(fouling_of(box).p4 == 5);
        CHECK(fouling_of(box).p200 == 0);
    }

    TEST_CASE("the sensor rocks have the shapes that the user names, place by place") {
        BallastBox box;
        const auto shapes_of = [&](const std::string& names) {
            box.sensor_shape = names;
            World world = make_box_world(box, 1);
            std::vector<std::uint32_t> shapes;
            for (const BoxSensor& sensor : world.resource<BoxBodies>().sensors)
                shapes.push_back(value_of<ShapeOf>(world, sensor.body));
            return shapes;
        };
        // a slice has three places with two sensors each; the library is in the order of the names
        using Shapes = std::vector<std::uint32_t>;
        CHECK(shapes_of(box.sensor_shape) == Shapes{0, 0, 1, 1, 2, 2});
        CHECK(shapes_of("rock_05,rock_07") == Shapes{5, 5, 7, 7, 5, 5});
        CHECK(refusal_of([&] { (void)shapes_of("pebble"); }).starts_with("--sensor-shape"));
    }

    TEST_CASE("fields of a file that do not cover the ballast are refused") {
        const TemporaryDirectory folder;
        const VoxelBlocks blocks({Vec3::Constant(0.01), 0.02}, {{0, 0, 0}});
        VoxelField fines(blocks), shown(blocks);
        for (std::uint32_t n = 0; n < blocks.voxels(); ++n) fines[n] = shown[n] = 1;
        write_vdb(folder / "small.vdb", blocks, {{"fines", "kg/m3", "Fines.", {&fines}, &shown}}, 0,
                  {});
        BallastBox box;
        box.run = "II.2";
        box.fouling.file = folder / "small.vdb";
        CHECK(refusal_of([&] { check_box(box); }).find("expected voxels that cover the ballast") !=
              std::string::npos);
    }

    TEST_CASE("a wet run has the water of the file of its fines, or else its own") {
        const TemporaryDirectory folder;
        std::vector<Voxel> corners; // blocks of eight voxels, 0.4 m wide
        for (int x = -1; x < 3; ++x)
            for (int y = -1; y < 6; ++y)
                for (int z = -1; z < 3; ++z) corners.push_back({8 * x, 8 * y, 8 * z});
        const VoxelBlocks blocks({Vec3::Constant(0), 0.05}, corners);
        VoxelField fines(blocks), shown(blocks);
        for (std::uint32_t n = 0; n < blocks.voxels(); ++n) fines[n] = shown[n] = 1;
        std::vector<FieldToWrite> grids{{"fines", "kg/m3", "Fines.", {&fines}, &shown}};
        write_vdb(folder / "fines.vdb", blocks, grids, 0, {});
        grids.push_back({"saturation", "1", "Water.", {&shown}, &shown});
        write_vdb(folder / "both.vdb", blocks, grids, 0, {});

        BallastBox box;
        box.run = "II.3";
        box.fouling.file = folder / "fines.vdb";
        CHECK(refusal_of([&] { check_box(box); }) == "");
        CHECK(fouling_of(box).saturation == 0.9);
        CHECK(fouling_of(box).p4 == 0);
        box.fouling.saturation = 0.5;
        CHECK(refusal_of([&] { check_box(box); }) == "");
        CHECK(fouling_of(box).saturation == 0.5);
        box.fouling.file = folder / "both.vdb";
        CHECK(refusal_of([&] {
                  check_box(box);
              }).ends_with("which has a grid saturation, found 0.5"));
        box.fouling.saturation = 0;
        CHECK(refusal_of([&] { check_box(box); }) == "");
    }

    TEST_CASE("fits to the last decade of cycles find a logarithmic and a power law") {
        std::vector<CycleResponse> logarithmic(200), power(200);
        for (std::size_t n = 1; n <= 200; ++n) {
            const auto x = static_cast<double>(n);
            logarithmic[n - 1].settlement = 1e-3 + 2e-4 * std::log(x);
            power[n - 1].settlement = 1e-3 * std::pow(x, 0.3);
        }
        CHECK(fit_logarithmic(logarithmic).slope == about(2e-4).epsilon(1e-9));
        CHECK(fit_logarithmic(logarithmic).intercept == about(1e-3).epsilon(1e-9));
        CHECK(fit_logarithmic(logarithmic).residual < 1e-15);
        CHECK(fit_power(power).slope == about(0.3).epsilon(1e-9));
        CHECK(fit_power(power).intercept == about(1e-3).epsilon(1e-9));
        CHECK(fit_power(power).residual < 1e-15);
        CHECK(fit_logarithmic(power).residual > 1e-5);
        power.back().settlement = -1;
        CHECK(std::isnan(fit_power(power).slope));
    }

    TEST_CASE("the whole box has four whole ties, of which the middle ones are below actuators") {
        BallastBox box;
        box.model = "full";
        box.rock_scale = 4; // few rocks
        const BoxSizes s = box_sizes(box);
        REQUIRE(s.ties.size() == 4);
        CHECK(s.ties[0] + s.ties[3] == about(3.96));
        CHECK(s.tie_end() == about(1.68 + 1.295));
        const auto shares = tie_shares(box);
        REQUIRE(shares.size() == 4);
        for (std::size_t actuator = 0; actuator < 2; ++actuator) {
            double sum = 0;
            for (const auto& of_tie : shares) sum += of_tie[actuator];
            CHECK(sum == about(1));
            CHECK(shares[s.loaded[actuator]][actuator] > 0.3);
        }
        CHECK(shares[0][0] == about(shares[3][1])); // by symmetry
        // the same box with half ties: the rails lie on the same four ties
        BallastBox half;
        half.model = "dynamic";
        half.box_ties = 4;
        CHECK(tie_shares(half)[0][0] == about(shares[1][0]));

        const World world = make_box_world(box, 1);
        const auto& bodies = world.resource<BoxBodies>();
        const auto mass = [&](EntityId body) {
            return world.column<Bodies, Mass>()[row_of_body(world, body)];
        };
        REQUIRE(bodies.ties.size() == 4);
        for (const EntityId tie : bodies.ties) CHECK(mass(tie) == about(2400 * 2.59 * 0.27 * 0.23));
        CHECK(bodies.sensors.size() == 8);
        for (const BoxSensor& sensor : bodies.sensors) {
            CHECK(sensor.place.y() > 1.6);
            CHECK(sensor.place.y() < s.tie_end());
        }
    }

    TEST_CASE("the state of a box of another version is refused by name") {
        Archive archive;
        BoxState().save(archive);
        BoxState().load(archive);
        std::vector<double> numbers = archive.get<double>("box");
        numbers.resize(numbers.size() - 3);
        Archive older;
        older.put("box", std::span<const double>(numbers));
        CHECK(refusal_of([&] {
                  BoxState().load(older);
              }).starts_with("box: expected 20 numbers, found 17"));
    }

    TEST_CASE("cycles are evaluated at their least load: settlement, rebound, stiffness and loop") {
        // loading along one line, unloading along a steeper one, so each cycle leaves 1 mm
        SeriesOf<CycleSample> samples("box");
        constexpr int n = 50;
        for (int k = 1; k <= 3 * n; ++k) {
            const double phase = static_cast<double>(k % n) / n;
            const int cycle = (k - 1) / n;
            const double up = phase > 0 && phase <= 0.5 ? 2 * phase : 0,
                         down = phase > 0.5 ? 2 * (1 - phase) : 0;
            const double load = phase == 0 ? 0 : up + down,
                         deflection = 1e-3 * cycle +
                                      (phase > 0 && phase <= 0.5 ? 5e-3 * up : 1e-3 + 4e-3 * down);
            // 1 kN of weight; the subgrade of 50 kN/mm gives 2 of the 4 mm, elastic contacts 0.5 mm
            const double carried = 1e3 + 100e3 * load;
            CycleSample now{};
            now.cycle = static_cast<double>(k) / n;
            now.load_1 = 100e3 * load;
            now.deflection_1 = deflection;
            now.tie_load = now.tie_support = carried;
            now.subgrade_energy = 0.5 * carried * carried / 50e6;
            now.contact_energy = 0.5 * carried * carried / 200e6;
            samples.add(now);
        }
        const auto cycles = cycle_responses(samples, 1);
        REQUIRE(cycles.size() == 3);
        for (std::size_t c = 0; c < 3; ++c) {
            CHECK(cycles[c].settlement == about(1e-3 * static_cast<double>(c + 1)));
            CHECK(cycles[c].resilient == about(4e-3));
            CHECK(cycles[c].of_subgrade == about(2e-3));
            CHECK(cycles[c].of_contacts == about(0.5e-3));
            CHECK(cycles[c].stiffness == about(100e3 / 4e-3));
        }
        // area between the lines: 100 kN (5 - 4) mm / 2
        CHECK(cycles[1].loop_area == about(50).epsilon(1e-6));
    }

    TEST_CASE("a bladder is stiff while it is full and gives way beyond its pressure") {
        constexpr double pressure = 200e3, area = 0.2 * 0.3, stop = 1e9, mass = 100;
        for (const double push : {0.5, 1.5}) { // of pressure times area, by a rock
            World world = make_world(Grains::clumps);
            Material material = linear_material(1e8, 0, 0, 2600);
            const auto number = add_material(world, material);
            const EntityId bladder = add_block(world, Vec3(0, 0.15, 0), Quat(Quat::Identity()),
                                               Vec3(0.3, 0.3, 0.2), mass, number);
            const double force = pressure * area;
            add_patch(world, bladder,
                      {.anchor = Vec3(0, 0.15 + force / stop, 0),
                       .axis = Vec3::UnitY(),
                       .stiffness = stop,
                       .damping = std::sqrt(stop * mass),
                       .one_sided = true});
            add_load(world, bladder, {.force = Vec3(0, -force, 0)});
            const EntityId rock = add_sphere(world, Vec3(0, -0.03, 0), 0.03, number);
            add_load(world, rock,
                     {.force = Vec3(0, 1, 0),
                      .history = {.times = {0, 0.02}, .values = {0, push * force}}});
            Simulation sim = begin(std::move(world), {.dt = 1e-6, .unlimited = true});
            sim.advance(30'000);
            const double moved = value_of<Position>(sim, bladder).y() - 0.15;
            CAPTURE(push);
            if (push < 1) {
                CHECK(moved == about(push * force / stop).epsilon(1e-2));
                CHECK(moved < 1e-4);
            } else {
                CHECK(moved > 1e-4); // (push - 1) force drives it back
            }
        }
    }

    TEST_CASE("the two halves of a rock and its mirror image move as the rock at a mirror side") {
        // two equal spheres that meet head on obliquely, and one of them at a mirror side
        const auto rebound = [](bool mirror) {
            World world = make_world(Grains::clumps);
            Material m = linear_material(1e6, 8e5, 0.5, 2600);
            m.restitution = 0.6;
            const auto rock = add_material(world, m);
            Material side = rigid_material(0);
            side.restitution = 0.6;
            const auto rigid = add_material(world, side);
            const Clump shape = scaled(small_rock(), 0.05);
            const Quat turned = exponential_map(Vec3(0.4, -0.2, 0.7));
            const EntityId a = add_clump(world, shape, 0, Vec3(0.0508, 0, 0), turned, rock);
            value_of<Velocity>(world, a) = Vec3(-1, 0.3, 0.1);
            if (mirror) {
                const EntityId host = add_boundary(world, Vec3::Zero(), rigid);
                add_plane(world, host, Vec3::Zero(), Vec3::UnitX());
            } else {
                Clump reflected = shape;
                for (Ball& ball : reflected.balls) ball.centre = -ball.centre;
                // the mirror image in x of a shape is its inversion turned by half a turn about x
                const Quat half(0, 1, 0, 0);
                const EntityId b =
                    add_clump(world, reflected, 0, Vec3(-0.0508, 0, 0), half * turned, rock);
                value_of<Velocity>(world, b) = Vec3(1, 0.3, 0.1);
            }
            Simulation sim = begin(std::move(world),
                                   {.dt = 1e-6, .law = LawName::linear_viscous, .unlimited = true});
            sim.advance(30'000);
            return std::pair(value_of<Velocity>(sim, a), value_of<AngularVelocity>(sim, a));
        };
        const auto [v, w] = rebound(true);
        const auto [v_pair, w_pair] = rebound(false);
        CHECK(v.x() > 0.05);
        CHECK((v - v_pair).norm() < 1e-9);
        CHECK((w - w_pair).norm() < 1e-7);
    }
}

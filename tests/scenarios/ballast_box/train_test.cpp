#include "engine/errors.hpp"
#include "scenarios/ballast_box/box_scene.hpp"
#include "scenarios/ballast_box/shells.hpp"
#include "scenarios/ballast_box/tie_under_rails.hpp"
#include "scenarios/ballast_box/train.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/start.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>

using namespace bris;

namespace {

constexpr RailOnTies usual{
    .bending = 1.58e7, .tie_support = 3e7, .spacing = 0.61, .tie_weight = 3790};

std::string file_with(const TemporaryDirectory& folder, const std::string& rows) {
    const auto path = folder.path() / "train.csv";
    std::ofstream(path) << "position_m,axle_load_kN\n" << rows;
    return path.string();
}

} // namespace

TEST_SUITE("ballast_box") {
    TEST_CASE("a hanging tie is pushed as much as one that lies on its support, and less on softer "
              "ballast") {
        const Train train{.name = "light, so that it lifts no tie",
                          .axles = {{0, 9e4}, {1.8, 9e4}}};
        const double speed = 1, mass = usual.tie_weight / 9.81; // slow: the dashpot does little
        for (const double pad : {std::numeric_limits<double>::infinity(), 120e6}) {
            RailOnTies rails = usual;
            rails.pad = pad;
            const double k = stiffness_above_tie(rails),
                         bed = 1 / (1 / rails.tie_support - 1 / rails.pad);
            const LoadHistory lies = passing_load(train, speed, rails, 800),
                              hangs = passing_load_of_hanging_tie(train, speed, rails, 800, mass);
            const double most = std::ranges::max(lies.values);
            REQUIRE(lies.values.size() == hangs.values.size());
            for (std::size_t n = 0; n < lies.values.size(); n += 1000) {
                // of axles alone
                const double push = hangs.values[n] + usual.tie_weight,
                             carried = bed * push / (k + bed);
                CHECK(std::abs(carried - (lies.values[n] - 800)) < 5e-4 * most);
                CHECK(std::abs(0.5 * bed * push / (k + 0.5 * bed)) <= std::abs(carried) + 1e-9);
            }
        }
    }

    TEST_CASE("a hanging tie that touches nothing follows the rails") {
        Simulation simulation = start(make_box_world({.model = "bay", .rock_scale = 2.5}, 1),
                                      {.law = LawName::linear_viscous});
        const EntityId tie = simulation.world().resource<BoxBodies>().ties.front();
        Vec3 at = value_of<Position>(simulation, tie);
        at.z() = 1.5;
        release(simulation.world(), tie, at);
        hang_tie(simulation.world(), usual, 0.5, 0.002);
        constexpr double guides = 2e-7; // against rotation give way by 0.2 um
        simulation.prepare();
        simulation.world().resource<Clock>().dt = 1e-5;
        simulation.advance(20'000);
        CHECK(value_of<Position>(simulation, tie).z() == about(1.502).epsilon(guides));
        auto& load = simulation.world().resource<Loads>();
        const double deflection = 0.003, stiffness = 0.5 * stiffness_above_tie(usual);
        load.of_body[value_of<LoadOf>(simulation, tie) - 1].front().history.mean +=
            stiffness * deflection;
        simulation.advance(40'000);
        CHECK(value_of<Position>(simulation, tie).z() == about(1.502 - deflection).epsilon(guides));
    }

    TEST_CASE("shells give sensor rocks their density and friction once, and leave all other rocks "
              "as they were") {
        const BallastBox box{
            .model = "bay", .rock_scale = 2.5, .sensor_density = 1200, .sensor_friction = 0.3};
        World world = make_box_world(box, 1);
        const auto& bodies = world.resource<BoxBodies>();
        const auto& materials = world.resource<Materials>();
        const double of_rocks = materials.list[bodies.rock].density;
        const EntityId sensor = bodies.sensors.front().body, rock = bodies.rocks[0].front();
        REQUIRE(materials.list[bodies.shell].density == of_rocks);
        const double mass = value_of<Mass>(world, sensor), other = value_of<Mass>(world, rock);
        const Vec3 inertia = value_of<Inertia>(world, sensor);
        for (int times = 0; times < 2; ++times) {
            change_shells(world, box);
            set_materials(world);
            CHECK(value_of<Mass>(world, sensor) == about(mass * 1200 / of_rocks));
            CHECK(value_of<InertialMass>(world, sensor) == value_of<Mass>(world, sensor));
            CHECK(value_of<Inertia>(world, sensor).z() == about(inertia.z() * 1200 / of_rocks));
            CHECK(value_of<InertialInertia>(world, sensor) == value_of<Inertia>(world, sensor));
            CHECK(materials.list[bodies.shell].friction == 0.3);
            CHECK(value_of<Mass>(world, rock) == other);
            CHECK(materials.list[bodies.rock].friction == bodies.hard[bodies.rock].friction);
        }
        CHECK(bodies.sensors.size() == 8);
    }

    TEST_CASE("the impulse of a passing train on a tie is its weight times the spacing over the "
              "speed, and it begins and ends with the weight of the rails") {
        const double speed = 20, dead_load = 800;
        for (const char* name : {"passenger", "freight"}) {
            const Train train = train_named(name);
            const LoadHistory load = passing_load(train, speed, usual, dead_load);
            double weight = 0, heaviest = 0, impulse = 0, most = 0;
            for (const Axle& axle : train.axles) {
                weight += axle.load;
                heaviest = std::max(heaviest, axle.load);
            }
            for (std::size_t k = 1; k < load.times.size(); ++k) {
                impulse += 0.5 * (load.values[k] + load.values[k - 1] - 2 * dead_load) *
                           (load.times[k] - load.times[k - 1]);
                most = std::max(most, load.values[k]);
            }
            CHECK(impulse == about(weight * usual.spacing / speed).epsilon(1e-4));
            CHECK(load.values.front() == about(dead_load).epsilon(1e-5 * heaviest / dead_load));
            CHECK(load.values.back() == about(dead_load).epsilon(1e-5 * heaviest / dead_load));
            CHECK(load.times.back() == about(passing_time(train, speed, usual)).epsilon(1e-12));
            CHECK(most > 0.9 * usual.influence()(0) * heaviest); // neighbours lift the rails
            CHECK(most < 2 * usual.influence()(0) * heaviest);
        }
    }

    TEST_CASE("a train in other units, with semicolons or by spacings is the same train, and says "
              "how it was read") {
        const TemporaryDirectory folder;
        const auto read = [&](const std::string& text) {
            std::ofstream(folder / "train.csv") << text;
            return train_named((folder / "train.csv").string());
        };
        const Train plain = read("position_m,axle_load_kN\n0,221\n1.8,221\n6.45,221\n");
        CHECK(plain.read_as.empty());
        const double tonnes = 221 / 9.80665, feet = 1.8 / 0.3048, more = 4.65 / 0.3048;
        for (const std::string& text :
             {std::string("position_m;axle_load_kN\n0;221\n1,8;221\n6,45;221\n"),
              std::string("axle,spacing_mm,axle load [N]\n1,0,221000\n2,1800,221000\n"
                          "3,4650,221000\n"),
              fmt::format("axle,spacing_m,load_t\n1,0,{0}\n2,1.8,{0}\n3,4.65,{0}\n", tonnes),
              fmt::format("spacing (ft)\tload (kip)\n0\t{0}\n{1}\t{0}\n{2}\t{0}\n",
                          221 / 4.4482216152605, feet, more)}) {
            CAPTURE(text);
            const Train train = read(text);
            REQUIRE(train.axles.size() == 3);
            for (std::size_t k = 0; k < 3; ++k) {
                CHECK(std::abs(train.axles[k].behind - plain.axles[k].behind) < 1e-12);
                CHECK(train.axles[k].load == about(plain.axles[k].load).epsilon(1e-12));
            }
            CHECK_FALSE(train.read_as.empty());
        }
        CHECK(read("spacing_m;load_t\n0;22,5\n1,8;22,5\n").read_as ==
              "semicolons and decimal commas, 'spacing_m' as spacings of axles, 'load_t' as their "
              "loads");
        const auto refusal = [&](const std::string& text) {
            const std::string message = message_of<InputError>([&] { (void)read(text); });
            return message.substr(message.find("train.csv"));
        };
        CHECK(refusal("position_m,wheel_load_kN\n0,100\n") ==
              "train.csv: expected a column 'axle_load_kN', found position_m, wheel_load_kN");
        CHECK(refusal("position_m,axle_load [stone]\n0,100\n")
                  .ends_with("in the title, as axle_load [kN], found 'stone'"));
        CHECK(refusal("position,axle_load_kN\n0,100\n").ends_with("as position [m], found none"));
        CHECK(refusal("position_m,spacing_m,axle_load_kN\n0,0,100\n") ==
              "train.csv: expected a column of positions or one of spacings, found both");
        CHECK(refusal("spacing_m,load_t\n0,22.5\n0,22.5\n") ==
              "train.csv:3: expected a spacing_m above 0, found 0");
    }

    TEST_CASE("a train that is impossible is refused with the line of its file") {
        const TemporaryDirectory folder;
        CHECK(train_named(file_with(folder, "0,100\n2.5,100\n")).length() == 2.5);
        const auto refused = [&](const std::string& rows, const char* message) {
            CHECK_THROWS_WITH_AS(train_named(file_with(folder, rows)), doctest::Contains(message),
                                 InputError);
        };
        refused("", "train.csv: expected at least one axle, found none");
        refused("1,100\n", "train.csv:2: expected position_m 0 of the first axle, found 1");
        refused("0,100\n0,100\n",
                "train.csv:3: expected a position_m greater than that of the axle before, found 0");
        refused("0,100\n2,-\n",
                "train.csv:3: expected a load above 0 and at most 500 in 'axle_load_kN', found -");
        refused("0,221000\n1.8,221000\n",
                "train.csv:2: expected a load above 0 and at most 500 in 'axle_load_kN', found "
                "221000");
        CHECK_THROWS_WITH_AS(train_named("tram"),
                             doctest::Contains("freight, inspection, locomotive, passenger"),
                             InputError);
    }
}

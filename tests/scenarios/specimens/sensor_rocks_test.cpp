#include "engine/errors.hpp"
#include "scenarios/specimens/sensor_rocks.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <fstream>

using namespace bris;

namespace {

const SensorRoom room{0.15, 0.6, 0.03};
const std::string names = "x_over_radius,y_over_radius,z_over_height,qw,qx,qy,qz\n";

std::string complaint(const std::string& text) {
    const TemporaryDirectory directory;
    const auto path = directory / "poses.csv";
    std::ofstream(path) << text;
    try {
        (void)placed_in(room, read_sensor_poses(path));
    } catch (const InputError& e) {
        return e.what();
    }
    return "none";
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

} // namespace

TEST_SUITE("specimens/sensor_rocks") {
    TEST_CASE("ten sensor rocks at three heights touch neither each other nor the "
              "membrane") {
        const auto poses = smart_rock_poses(room, 1, smart_rock_count(room));
        REQUIRE(poses.size() == 10);
        for (std::size_t a = 0; a < poses.size(); ++a) {
            CHECK(poses[a].position.head<2>().norm() + room.bounding_radius <= room.radius);
            CHECK(poses[a].orientation.norm() == about(1).epsilon(1e-14));
            for (std::size_t b = 0; b < a; ++b)
                CHECK((poses[a].position - poses[b].position).norm() > 1.7 * room.bounding_radius);
        }
    }

    TEST_CASE("a smaller mould contains the seven sensor rocks beside the membrane or the three in "
              "the centre, without contact") {
        for (const double radius : {0.046, 0.058, 0.063, 0.075, 0.083, 0.086}) {
            const SensorRoom small{radius, 4 * radius, 0.03};
            const auto poses = smart_rock_poses(small, 1, smart_rock_count(small));
            CAPTURE(radius);
            CHECK(poses.size() == (radius < 0.062 ? 3 : radius < 0.0846 ? 7 : 10));
            for (std::size_t a = 0; a < poses.size(); ++a) {
                CHECK(poses[a].position.head<2>().norm() + small.bounding_radius <= small.radius);
                for (std::size_t b = 0; b < a; ++b)
                    CHECK((poses[a].position - poses[b].position).norm() >
                          1.5 * small.bounding_radius);
            }
        }
    }

    TEST_CASE("poses in a file are relative to the radius and height of the mould") {
        const TemporaryDirectory directory;
        std::ofstream(directory / "poses.csv")
            << names << "0,0.5,0.25,1,0,0,0\n-0.5,0,0.75,0.5,0.5,0.5,0.5\n";
        const auto poses = placed_in(room, read_sensor_poses(directory / "poses.csv"));
        REQUIRE(poses.size() == 2);
        CHECK((poses[0].position - Vec3(0, 0.075, 0.15)).norm() < 1e-15);
        CHECK((poses[1].position - Vec3(-0.075, 0, 0.45)).norm() < 1e-15);
        CHECK(poses[1].orientation.angularDistance(Quat(0.5, 0.5, 0.5, 0.5)) < 1e-12);
    }

    TEST_CASE("an impossible pose is refused with its line") {
        CHECK(has(complaint(names + "0,0,0.5,1,0,0,0\n0,0.95,0.25,1,0,0,0\n"),
                  "poses.csv:3: expected a sensor rock inside the mould"));
        CHECK(has(complaint(names + "0,0,1.2,1,0,0,0\n"),
                  "poses.csv:2: expected a sensor rock inside"));
        CHECK(
            has(complaint(names + "0,0,0.5,1,1,0,0\n"), "poses.csv:2: expected a unit quaternion"));
        CHECK(has(complaint(names + "0,0,0.5,1,0,0,0\n0,0,0.55,1,0,0,0\n"),
                  "poses.csv:3: expected sensor rocks clear of each other"));
        CHECK(has(complaint(names), "expected a line for each sensor rock"));
        CHECK(has(complaint("x,y\n1,2\n"), "x_over_radius"));
    }
}

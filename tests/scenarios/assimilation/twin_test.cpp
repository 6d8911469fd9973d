#include "engine/signal/attitude.hpp"
#include "scenarios/assimilation/twin.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/assimilation/steady_run.hpp"

#include <doctest/doctest.h>

using namespace bris;
using testing::steady_run;

TEST_SUITE("procedure/twin") {
    TEST_CASE("sensors without error tell where rocks went, tracked ones with their noise") {
        const ModelRun truth = steady_run();
        const Told ideal = told_by_sensors(truth, {.mode = "ideal"}, 1),
                   tracked = told_by_sensors(truth, {.position_noise = 1e-3}, 1);
        REQUIRE(ideal.ways.size() == 3);
        REQUIRE(ideal.ways[1].strain.size() == 10);
        CHECK((ideal.ways[1].displacement[9] - truth.displacement[100][1]).norm() <
              5 * ideal.position_noise);
        CHECK(ideal.position_noise == 1e-7);
        CHECK(tracked.position_noise == 1e-3);
        double squares = 0;
        for (std::size_t s = 0; s < 3; ++s)
            for (std::size_t k = 0; k < 10; ++k)
                squares += (tracked.ways[s].displacement[k] - truth.displacement[10 * (k + 1)][s])
                               .squaredNorm() /
                           90;
        CHECK(std::sqrt(squares) == about(1e-3).epsilon(0.25)); // of 90 numbers: to 7 %
    }

    TEST_CASE("an inertial sensor tells tilt and nothing else, as well as its preset says") {
        const ModelRun truth = steady_run();
        double before = 0;
        for (const char* imu : {"lab-grade", "smartrock-like"}) {
            CAPTURE(imu);
            const Told told = told_by_sensors(truth, {.mode = "honest-imu", .imu = imu}, 1);
            CHECK(told.refused == 0);
            for (std::size_t s = 0; s < 3; ++s) {
                REQUIRE(told.ways[s].strain.size() == 10);
                const Quat start = truth.start[s].orientation,
                           now = exponential_map(truth.rotation[100][s]) * start;
                const Vec3 tilt =
                    start.conjugate() * Vec3::UnitZ() - now.conjugate() * Vec3::UnitZ();
                CHECK((told.ways[s].tilt[9] - tilt).norm() < 4 * told.attitude_noise);
                CHECK_FALSE(told.ways[s].displacement[9].allFinite());
                CHECK_FALSE(told.ways[s].rotation[9].allFinite());
            }
            CHECK(told.attitude_noise > 3 * before);
            before = told.attitude_noise;
        }
        CHECK(before == about(1e-3).epsilon(0.05)); // the bias, a thousandth of g: the noise of a
                                                    // mean over 12 s is a thirtieth of that
    }
}

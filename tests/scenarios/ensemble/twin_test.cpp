#include "engine/signal/attitude.hpp"
#include "engine/signal/imu.hpp"
#include "scenarios/ensemble/twin.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/ensemble/steady_run.hpp"

#include <doctest/doctest.h>

using namespace bris;
using testing::steady_run;

TEST_SUITE("ensemble/twin") {
    TEST_CASE("ideal sensors observe the displacements exactly, tracked ones with their noise") {
        const ModelRun truth = steady_run();
        const SensorObservations ideal = observe_sensors(truth, {.mode = SensorMode::ideal}, 1),
                                 tracked = observe_sensors(truth, {.position_noise = 1e-3}, 1);
        REQUIRE(ideal.trajectories.size() == 3);
        REQUIRE(ideal.trajectories[1].strain.size() == 10);
        CHECK((ideal.trajectories[1].displacement[9] - truth.displacement[100][1]).norm() <
              5 * ideal.position_noise);
        CHECK(ideal.position_noise == 1e-7);
        CHECK(tracked.position_noise == 1e-3);
        double squares = 0;
        for (std::size_t s = 0; s < 3; ++s)
            for (std::size_t k = 0; k < 10; ++k)
                squares +=
                    (tracked.trajectories[s].displacement[k] - truth.displacement[10 * (k + 1)][s])
                        .squaredNorm() /
                    90;
        CHECK(std::sqrt(squares) == about(1e-3).epsilon(0.25)); // 90 numbers give 7 %
    }

    TEST_CASE("an inertial sensor observes tilt and nothing else, with the noise of its preset") {
        const ModelRun truth = steady_run();
        double before = 0;
        for (const char* imu : {"lab-grade", "smartrock-like"}) {
            CAPTURE(imu);
            const SensorObservations observations =
                observe_sensors(truth, {.mode = SensorMode::inertial, .imu = imu}, 1);
            CHECK(observations.refused == 0);
            for (std::size_t s = 0; s < 3; ++s) {
                REQUIRE(observations.trajectories[s].strain.size() == 10);
                const Quat start = truth.start[s].orientation,
                           now = exponential_map(truth.rotation[100][s]) * start;
                const Vec3 tilt =
                    start.conjugate() * Vec3::UnitZ() - now.conjugate() * Vec3::UnitZ();
                CHECK((observations.trajectories[s].tilt[9] - tilt).norm() <
                      4 * observations.attitude_noise);
                CHECK_FALSE(observations.trajectories[s].displacement[9].allFinite());
                CHECK_FALSE(observations.trajectories[s].rotation[9].allFinite());
            }
            CHECK(observations.attitude_noise > 3 * before);
            before = observations.attitude_noise;
        }
        // the bias, a thousandth of g; the noise of a mean over 12 s is a thirtieth of that
        CHECK(before == about(1e-3).epsilon(0.05));
    }

    TEST_CASE("the recorded rates of a sensor rock that turns about a fixed axis add up to its "
              "rotation") {
        const ModelRun truth = steady_run();
        const RecordingSettings settings{.imu = "ideal"};
        const auto recordings = record_sensors(truth, settings, 1);
        REQUIRE(recordings.size() == 3);
        const double period = settings.interval / 1e-4 * settings.stage_time;
        for (std::size_t s = 0; s < 3; ++s) {
            Vec3 turned = Vec3::Zero(); // in the axes of the rock, in which the axis is fixed too
            for (const Vec3& rate : recordings[s].rate) turned += period * rate;
            const Vec3 expected = truth.start[s].orientation.conjugate() * truth.rotation[100][s];
            CHECK((turned - expected).norm() < 1e-12);
        }
    }

    TEST_CASE("a recording states the noise and the biases of its class of devices") {
        const ImuModel model = imu_preset("cheap");
        for (const Recording& r : record_sensors(steady_run(), {.imu = "cheap"}, 1)) {
            CHECK(r.info.force_noise == model.noise.force);
            CHECK(r.info.rate_noise == model.noise.rate);
            CHECK(r.info.force_bias == model.force_bias);
            CHECK(r.info.rate_bias == model.rate_bias);
            CHECK(r.info.force_range == model.force_range);
            CHECK(r.info.rate_range == model.rate_range);
        }
    }
}

#include "engine/errors.hpp"
#include "engine/signal/attitude.hpp"
#include "scenarios/sensors/sensor_trajectory.hpp"
#include "systems/fusion/sensor_filter.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

using namespace bris;

namespace {

const Quat start = exponential_map(Vec3(0.3, -0.8, 1.2));

/// A rock that rotates by `turn` and moves by `shift` in steps of 0.1 % of strain, at rest at each
/// step; its accelerometers have a bias.
Recording slow_recording(const Vec3& turn, const Vec3& shift, const Vec3& bias = Vec3::Zero()) {
    Recording r;
    r.info.id = 4;
    r.info.set_pose(Vec3(0.01, 0.02, 0.03), start);
    for (int k = -2; k <= 10; ++k) {
        const double part = std::max(0, k) / 10.0;
        const Quat now = exponential_map(part * turn) * start;
        r.time.push_back(12.0 * (k + 2));
        r.sequence.push_back(static_cast<std::uint64_t>(k + 2));
        r.strain.push_back(std::max(0, k) * 1e-3);
        r.force.push_back(now.conjugate() * Vec3(0, 0, 9.81) + bias);
        r.rate.push_back(Vec3::Zero());
        r.displacement.push_back(Vec3(1, 2, 3) + part * shift);
        r.attitude.push_back(now);
    }
    return r;
}

} // namespace

TEST_SUITE("sensors/sensor_trajectory") {
    TEST_CASE(
        "a trajectory contains displacement and rotation since the start if they were recorded") {
        const Vec3 turn(0.05, -0.02, 0.1), shift(1e-3, 0, -2e-3);
        Recording r = slow_recording(turn, shift);
        const SensorTrajectory trajectory = trajectory_of(r, 2e-3);
        REQUIRE(trajectory.strain.size() == 5);
        CHECK(trajectory.strain.back() == about(0.01));
        CHECK((trajectory.displacement.back() - shift).norm() < 1e-15);
        CHECK((trajectory.rotation.back() - turn).norm() < 1e-12);
        r.displacement.clear();
        r.attitude.clear();
        const SensorTrajectory inertial = trajectory_of(r, 2e-3);
        CHECK_FALSE(inertial.displacement.back().allFinite());
        CHECK_FALSE(inertial.rotation.back().allFinite());
        CHECK(inertial.tilt.back().allFinite());
        r.strain.clear();
        CHECK_THROWS_WITH_AS((void)trajectory_of(r, 1e-3), doctest::Contains("column strain"),
                             InputError);
    }

    TEST_CASE("gravity determines tilt whatever the bias of the accelerometers, and leaves yaw as "
              "it is") {
        const Vec3 turn(0.02, -0.03, 0);
        const Recording r = slow_recording(turn, Vec3::Zero(), Vec3(0.05, -0.02, 0.03));
        const SensorTrajectory trajectory = trajectory_of(r, 1e-2);
        Measured m;
        m.up = (start.conjugate() * Vec3::UnitZ() - trajectory.tilt.back()).normalized();
        m.attitude_deviation = 1e-6;
        const Quat yawed = exponential_map(Vec3(0, 0, 0.4)) * start; // the model has another yaw
        SensorFilter filter({.attitude = 0.5});
        const Analysis a = filter.update({0, {.orientation = yawed}}, m);
        const Quat corrected = exponential_map(a.turn) * yawed;
        CHECK((corrected * m.up - Vec3::UnitZ()).norm() < 1e-5);
        CHECK(std::abs(a.turn.z()) < 1e-3);
        // the vertical is the true one except for the bias, of which a small part remains
        const Quat truth = exponential_map(turn) * start;
        CHECK((truth * m.up - Vec3::UnitZ()).norm() < 0.05 / 9.81 * 0.1);
    }

    TEST_CASE("the displacement of a free inertial sensor is reported as not observable in a test "
              "of sixteen minutes") {
        Recording r = slow_recording(Vec3::Zero(), Vec3::Zero());
        const auto all = observability_of(r, 960, 1e-3, 0.1);
        REQUIRE(all.size() == 5);
        for (const Observability& entry : all) CHECK(entry.observable());
        r.displacement.clear();
        r.attitude.clear();
        const auto inertial = observability_of(r, 960, 1e-3, 0.1);
        for (std::size_t k = 0; k < 3; ++k) {
            CHECK_FALSE(inertial[k].observable());
            CHECK(inertial[k].deviation > 1); // metres
        }
        CHECK(inertial[3].observable()); // tilt
        CHECK_FALSE(
            inertial[4].observable()); // yaw: the integrated bias of the gyroscope is too large
        CHECK(observability_of(r, 0.05, 1e-3, 0.1)[0]
                  .observable()); // displacement during the passage of a wheel is observable
    }

    TEST_CASE("recordings that are written and read again are the same") {
        const TemporaryDirectory folder;
        Recording r = slow_recording(Vec3(0.1, 0, 0), Vec3(1e-3, 0, 0));
        r.info.force_unit = std::string("g");
        r.info.rate_unit = "deg/s";
        const Quat mounting = exponential_map(Vec3(1, 0.2, -0.4));
        r.info.mounting_w = mounting.w();
        r.info.mounting_x = mounting.x();
        r.info.mounting_y = mounting.y();
        r.info.mounting_z = mounting.z();
        write_sensor_info(folder / "rock_04.txt", r.info);
        write_recordings(folder / "recordings.csv", {r}, {"of a test"});
        const SensorInfo info = read_sensor_info(folder / "rock_04.txt");
        CHECK(info.id == 4);
        CHECK(info.attitude().angularDistance(start) < 1e-12);
        CHECK(info.force_unit == "g");
        const auto read = read_recordings(folder / "recordings.csv", {info});
        REQUIRE(read.front().size() == r.size());
        CHECK((read.front().force.back() - r.force.back()).norm() < 1e-5);
        CHECK(read.front().strain.back() == about(r.strain.back()));
        CHECK(read.front().sequence == r.sequence);
        CHECK((read.front().displacement.back() - r.displacement.back()).norm() < 1e-6);
        CHECK(read.front().attitude.back().angularDistance(r.attitude.back()) < 1e-6);
    }
}

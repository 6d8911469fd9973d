#include "engine/errors.hpp"
#include "engine/signal/imu.hpp"
#include "scenarios/ensemble/misfit.hpp"
#include "scenarios/ensemble/twin.hpp"
#include "scenarios/records/quality_control_report.hpp"
#include "scenarios/records/recorded_test.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/ensemble/steady_run.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <fstream>

using namespace bris;
using testing::placed, testing::scene_of, testing::steady_run;

namespace {

void replace_line(const std::filesystem::path& path, int number, const std::string& with) {
    std::ifstream in(path);
    std::string text, line;
    for (int k = 1; std::getline(in, line); ++k) text += (k == number ? with : line) + "\n";
    in.close();
    std::ofstream(path) << text;
}

} // namespace

TEST_SUITE("records/recorded_test") {
    TEST_CASE("a model run written as a folder of recordings is read back as the motion of its "
              "sensors") {
        const TemporaryDirectory folder;
        const ModelRun truth = steady_run();
        const auto recordings = record_sensors(truth, {}, 1);
        write_recorded_test(folder.path(), 110e3, placed(recordings, truth),
                            MeasuredCurves(truth.curves));
        const auto infos = read_sensor_infos(folder.path());
        REQUIRE(infos.size() == 3);
        const RecordedTest test = read_recorded_test(folder.path(), 110e3, infos, {});
        CHECK(test.refused() == 0);
        CHECK(test.curves.size() == 101);
        REQUIRE(test.trajectories[2].strain.size() == 10);
        CHECK((test.trajectories[2].displacement[9] - truth.displacement[100][2]).norm() <
              6e-4); // noise of 0.1 mm, twice
        CHECK((test.trajectories[2].rotation[9] - truth.rotation[100][2]).norm() < 0.02);
        const Misfit none = misfit_of(test, truth);
        CHECK(none.q < 1);
        CHECK(none.volumetric_strain < 1e-8);
        CHECK(none.sensor_displacement < 6e-4);
        ModelRun half = truth; // ends before the test
        half.curves = truth.curves.up_to(0.00505);
        CHECK(misfit_of(test, half).ring_strain < 1e-5);
        ModelRun other = truth;
        for (double& q : other.curves[quantity::deviatoric_stress]) q += 5e3;
        CHECK(misfit_of(test, other).q == about(5e3).epsilon(1e-3));

        // inertial channels alone: only the tilt
        const RecordedTest inertial = read_recorded_test(
            folder.path(), 110e3, infos, {.displacement = false, .attitude = false});
        const Vec3 tilt = inertial.trajectories[2].tilt[9];
        const Quat before = truth.start[2].orientation,
                   after = exponential_map(truth.rotation[100][2]) * before;
        CHECK((tilt - (before.conjugate() * Vec3::UnitZ() - after.conjugate() * Vec3::UnitZ()))
                  .norm() < 2e-3);
        CHECK_FALSE(inertial.trajectories[2].displacement[9].allFinite());
        CHECK(std::isnan(misfit_of(inertial, truth).sensor_displacement));
    }

    TEST_CASE("a sensor with a corrupted recording is refused, and the others are kept") {
        const ModelRun truth = steady_run();
        auto spoiled = record_sensors(truth, {}, 1);
        for (Vec3& f : spoiled[1].force) f = -f;
        const TemporaryDirectory folder;
        write_recorded_test(folder.path(), 55e3, placed(spoiled, truth),
                            MeasuredCurves(truth.curves));
        const RecordedTest test =
            read_recorded_test(folder.path(), 55e3, read_sensor_infos(folder.path()), {});
        CHECK(test.refused() == 1);
        CHECK(test.trajectories[1].strain.empty());
        CHECK_FALSE(test.trajectories[0].strain.empty());
    }

    TEST_CASE(
        "wrong measurements of the machine are left out with the reason, and all others are used") {
        const ModelRun truth = steady_run();
        const auto recordings = record_sensors(truth, {}, 1);
        const auto read = [&](auto&& change) {
            MeasuredCurves curves(truth.curves);
            for (std::size_t k = 0; k < curves.size(); ++k) change({curves, k}, k);
            const TemporaryDirectory folder;
            write_recorded_test(folder.path(), 55e3, placed(recordings, truth), curves);
            RecordedTest test =
                read_recorded_test(folder.path(), 55e3, read_sensor_infos(folder.path()), {});
            CHECK(test.refused() == 0);
            CHECK(test.trajectories[2].strain.size() == 10);
            return test;
        };
        const auto says = [](const RecordedTest& test, const std::string& text) {
            return quality_control_report(test).find(text) != std::string::npos;
        };
        const RecordedTest good = read([](const TestCurves::Row&, std::size_t) {});
        CHECK(says(good, "test machine: accepted, 101 records\nsensors 1 to 3: accepted, "));

        const RecordedTest wild = read([](const TestCurves::Row& p, std::size_t k) {
            if (k == 15) p[quantity::deviatoric_stress] = 1e12;
        });
        CHECK(says(wild, "test machine: deviatoric_stress_Pa: 1 of 101 records left out: expected "
                         "-5.5e+04 to 1.65e+06, found 1e+12 at 0.15 % of axial strain\n"));
        CHECK(std::isnan(wild.curves[quantity::deviatoric_stress][15]));
        CHECK(misfit_of(wild, truth).q < 1); // from the other records
        const RecordedTest kilo = read(
            [](const TestCurves::Row& p, std::size_t) { p[quantity::deviatoric_stress] *= 1e-3; });
        CHECK(says(kilo, "test machine: refused: deviatoric_stress_Pa: expected at least 1100 Pa"));
        CHECK(std::isnan(misfit_of(kilo, truth).q)); // not measured
        CHECK(misfit_of(kilo, truth).volumetric_strain < 1e-8);
        CHECK(says(read([](const TestCurves::Row& p, std::size_t) {
                       p[quantity::deviatoric_stress] *= -1;
                   }),
                   "refused: deviatoric_stress_Pa: expected positive values in compression"));
        CHECK(says(
            read([](const TestCurves::Row& p, std::size_t k) {
                if (k > 40) p[quantity::deviatoric_stress] = 7e4;
            }),
            "deviatoric_stress_Pa: 59 of 101 records left out: expected a change, found 7e+04"));
        const RecordedTest percent = read([](const TestCurves::Row& p, std::size_t k) {
            p[quantity::volumetric_strain] = -0.5 * static_cast<double>(k) * 1e-2;
        });
        CHECK(says(percent, "refused: volumetric_strain: ")); // -50 times the axial strain
        CHECK(says(percent, "is it in per cent?"));
        CHECK(std::isnan(misfit_of(percent, truth).volumetric_strain));
        CHECK(misfit_of(percent, truth).q < 1);
        const RecordedTest spike = read([](const TestCurves::Row& p, std::size_t k) {
            if (k == 70) p[quantity::volumetric_strain] = 0.3;
        });
        CHECK(says(spike, "volumetric_strain: 1 of 101 records left out: expected -0.036 to 0.008, "
                          "found 0.3 at 0.7 %"));
        CHECK(misfit_of(spike, truth).volumetric_strain < 1e-8);
        const RecordedTest ring = read([](const TestCurves::Row& p, std::size_t k) {
            if (k == 100) p.part(quantity::ring_radius, 3) = 75;
        });
        CHECK(says(ring, "ring_4_radius_m: 1 of 101 records left out"));
        CHECK(misfit_of(ring, truth).ring_strain < 1e-5);
    }

    TEST_CASE("faultless sensors of every class are accepted at every stage of a test") {
        const ModelRun truth = steady_run();
        for (const auto preset : imu_presets)
            for (std::uint64_t seed = 1; seed <= 20; ++seed)
                for (const std::size_t samples : {2u, 4u, 5u, 6u, 8u, 15u}) {
                    RecordedTest test;
                    test.recordings = record_sensors(truth, {.imu = std::string(preset)}, seed);
                    for (Recording& r : test.recordings) {
                        for (auto* numbers : {&r.time, &r.strain}) numbers->resize(samples);
                        for (auto* vectors : {&r.force, &r.rate, &r.displacement})
                            vectors->resize(samples);
                        r.sequence.resize(samples);
                        r.attitude.resize(samples);
                    }
                    examine(test, {});
                    INFO(preset << ", seed " << seed << "\n"
                                << quality_control_report(test.findings, test.recordings));
                    CHECK(test.refused() == 0);
                    for (const Finding& f : test.findings)
                        CHECK((f.check == "clock" ||
                               f.text.find("too few samples at rest") != std::string::npos));
                }
    }

    TEST_CASE(
        "the model's sensor rocks are placed where the metadata say, in the order of the ids") {
        const TemporaryDirectory folder;
        const ModelRun truth = steady_run();
        SpecimenSettings mould = scene_of(truth).specimen;
        std::vector<SmartRockPose> given_poses = scene_of(truth).poses;
        for (SmartRockPose& p : given_poses) p.position *= 0.9;
        write_recorded_test(folder.path(), 55e3,
                            with_poses(record_sensors(truth, {}, 1), mould, given_poses),
                            MeasuredCurves(truth.curves));
        const auto infos = read_sensor_infos(folder.path());
        SensorInfo elsewhere = infos[1]; // its pose at the start is known, and nothing else
        elsewhere.set_placed(Vec3::Zero(), Quat(0, 0, 0, 0));
        write_sensor_info(folder / "rock_02.txt", elsewhere);
        const auto given = with_recorded_poses({}, folder.path()).recorded_poses;
        REQUIRE(given.size() == 3);
        const auto poses = placed_in({mould.radius, mould.height, 1e-3}, given);
        CHECK((poses[0].position - given_poses[0].position).norm() < 1e-15);
        CHECK((poses[2].position - given_poses[2].position).norm() < 1e-15);
        CHECK(poses[2].orientation.angularDistance(given_poses[2].orientation) < 1e-7);
        CHECK((poses[1].position - infos[1].position()).norm() == 0);
        CHECK(poses[1].orientation.angularDistance(infos[1].attitude()) < 1e-7);
    }

    TEST_CASE("missing, truncated or unordered files are refused with the line") {
        const TemporaryDirectory folder;
        const ModelRun truth = steady_run();
        CHECK_THROWS_AS((void)read_sensor_infos(folder / "nowhere"), OutputError);
        CHECK_THROWS_WITH_AS((void)read_sensor_infos(folder.path()),
                             doctest::Contains("expected files rock_NN.txt"), InputError);
        write_recorded_test(folder.path(), 55e3, placed(record_sensors(truth, {}, 1), truth),
                            MeasuredCurves(truth.curves));
        const auto infos = read_sensor_infos(folder.path());
        CHECK(message_of<InputError>([&] {
                  (void)read_recorded_test(folder.path(), 165e3, infos, {});
              }).starts_with("--confining-pressure: expected a folder 165kPa in "));
        CHECK(message_of<InputError>([&] {
                  (void)read_recorded_test(folder.path(), 55, infos, {});
              }).ends_with(", found 55kPa: 55e3?"));
        const auto csv = folder / "55kPa" / "test.csv";
        replace_line(csv, 9, "0.0001,1,1,1,1,1,1,1,1,1,1");
        CHECK_THROWS_WITH_AS(
            (void)read_recorded_test(folder.path(), 55e3, infos, {}),
            doctest::Contains("test.csv:9: axial_strain: expected increasing numbers"), InputError);
        replace_line(csv, 9, "0.0006,12");
        CHECK_THROWS_WITH_AS((void)read_recorded_test(folder.path(), 55e3, infos, {}),
                             doctest::Contains("test.csv:9"), InputError);
        replace_line(csv, 3, "strain,q");
        CHECK(message_of<InputError>([&] {
                  (void)read_recorded_test(folder.path(), 55e3, infos, {});
              }).ends_with(" (--machine-columns describes files of other programs)"));
        std::ofstream(folder / "map") << "t = T\n";
        CHECK(message_of<InputError>([&] {
                  (void)read_recorded_test(folder.path(), 55e3, infos,
                                           {.machine_columns = folder / "map"});
              }).starts_with("--machine-columns: "));
        write_recorded_test(folder.path(), 55e3, placed(record_sensors(truth, {}, 1), truth),
                            MeasuredCurves(truth.curves));
        replace_line(csv, 9, "0.0006,,0,1,1,1,1,1,1,1,1");
        CHECK_THROWS_WITH_AS((void)read_recorded_test(folder.path(), 55e3, infos, {}),
                             doctest::Contains("deviatoric_stress_Pa: expected a number"),
                             InputError);
    }
}

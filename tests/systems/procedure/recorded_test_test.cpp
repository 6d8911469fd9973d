#include "engine/errors.hpp"
#include "systems/procedure/recorded_test.hpp"
#include "systems/procedure/twin.hpp"
#include "tests/about.hpp"
#include "tests/systems/procedure/steady_run.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <fstream>

using namespace bris;
using testing::scene_of, testing::steady_run;

namespace {

void replace_line(const std::filesystem::path& path, int number, const std::string& with) {
    std::ifstream in(path);
    std::string text, line;
    for (int k = 1; std::getline(in, line); ++k) text += (k == number ? with : line) + "\n";
    in.close();
    std::ofstream(path) << text;
}

} // namespace

TEST_SUITE("procedure/recorded_test") {
    TEST_CASE("a true run written as a folder of recordings is read back as what its sensors did") {
        const TemporaryDirectory folder;
        const ModelRun truth = steady_run();
        const auto recordings = record_sensors(truth, {}, 1);
        write_recorded_test(folder.path(), 110e3, recordings, scene_of(truth), truth.points);
        const auto infos = read_sensor_infos(folder.path());
        REQUIRE(infos.size() == 3);
        const RecordedTest test = read_recorded_test(folder.path(), 110e3, infos, {});
        CHECK(test.refused() == 0);
        CHECK(test.measured.size() == 101);
        REQUIRE(test.ways[2].strain.size() == 10);
        CHECK((test.ways[2].displacement[9] - truth.displacement[100][2]).norm() < 6e-4); // of 0.1 mm twice
        CHECK((test.ways[2].rotation[9] - truth.rotation[100][2]).norm() < 0.02);
        const Misfit none = misfit_of(truth, test);
        CHECK(none.q < 1);
        CHECK(none.volumetric_strain < 1e-8);
        CHECK(none.sensor_displacement < 6e-4);
        ModelRun half = truth; // ends before the test did
        half.points.resize(51);
        CHECK(misfit_of(half, test).ring_strain < 1e-5);
        ModelRun other = truth;
        for (TriaxialPoint& p : other.points) p.deviatoric_stress += 5e3;
        CHECK(misfit_of(other, test).q == about(5e3).epsilon(1e-3));

        // by inertia alone: tilt and nothing else
        const RecordedTest inertial = read_recorded_test(folder.path(), 110e3, infos, {.displacement = false, .attitude = false});
        const Vec3 tilt = inertial.ways[2].tilt[9];
        const Quat before = truth.start[2].orientation, after = exponential_map(truth.rotation[100][2]) * before;
        CHECK((tilt - (before.conjugate() * Vec3::UnitZ() - after.conjugate() * Vec3::UnitZ())).norm() < 2e-3);
        CHECK_FALSE(inertial.ways[2].displacement[9].allFinite());
        CHECK(std::isnan(misfit_of(truth, inertial).sensor_displacement));
    }

    TEST_CASE("a sensor whose recording is spoiled is refused, and the others stay") {
        const ModelRun truth = steady_run();
        auto spoiled = record_sensors(truth, {}, 1);
        for (Vec3& f : spoiled[1].force) f = -f;
        const TemporaryDirectory folder;
        write_recorded_test(folder.path(), 55e3, spoiled, scene_of(truth), truth.points);
        const RecordedTest test = read_recorded_test(folder.path(), 55e3, read_sensor_infos(folder.path()), {});
        CHECK(test.refused() == 1);
        CHECK(test.ways[1].strain.empty());
        CHECK_FALSE(test.ways[0].strain.empty());
    }

    TEST_CASE("files that are not there, cut off or not in order are refused with their line") {
        const TemporaryDirectory folder;
        const ModelRun truth = steady_run();
        CHECK_THROWS_AS((void)read_sensor_infos(folder / "nowhere"), OutputError);
        CHECK_THROWS_WITH_AS((void)read_sensor_infos(folder.path()), doctest::Contains("expected files rock_NN.txt"), InputError);
        write_recorded_test(folder.path(), 55e3, record_sensors(truth, {}, 1), scene_of(truth), truth.points);
        const auto infos = read_sensor_infos(folder.path());
        CHECK_THROWS_AS((void)read_recorded_test(folder.path(), 165e3, infos, {}), OutputError);
        const auto csv = folder / "55kPa" / "test.csv";
        replace_line(csv, 9, "0.0001,1,1,1,1,1,1,1,1,1,1");
        CHECK_THROWS_WITH_AS((void)read_recorded_test(folder.path(), 55e3, infos, {}), doctest::Contains("test.csv:9: axial_strain: expected numbers that grow"), InputError);
        replace_line(csv, 9, "0.0006,12");
        CHECK_THROWS_WITH_AS((void)read_recorded_test(folder.path(), 55e3, infos, {}), doctest::Contains("test.csv:9"), InputError);
        replace_line(csv, 9, "0.0006,,0,1,1,1,1,1,1,1,1");
        CHECK_THROWS_WITH_AS((void)read_recorded_test(folder.path(), 55e3, infos, {}), doctest::Contains("deviatoric_stress_Pa: expected a number"), InputError);
    }
}

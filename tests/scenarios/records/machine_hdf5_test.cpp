#include "engine/errors.hpp"
#include "engine/io/hdf5.hpp"
#include "scenarios/ensemble/twin.hpp"
#include "scenarios/records/machine_hdf5.hpp"
#include "scenarios/records/quality_control_report.hpp"
#include "scenarios/records/recorded_test.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/ensemble/steady_run.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <span>

using namespace bris;

TEST_SUITE("records/machine_hdf5") {
    TEST_CASE("a test written as one HDF5 file is read as the same test written as CSV files") {
        const TemporaryDirectory csv, hdf5;
        const ModelRun truth = testing::steady_run();
        const auto recordings = record_sensors(truth, {}, 1);
        std::vector<double> time;
        for (const double strain : truth.curves[quantity::axial_strain])
            time.push_back(60 + 1.2e4 * strain);
        write_recorded_test(csv.path(), 110e3, testing::placed(recordings, truth),
                            MeasuredCurves(truth.curves));
        write_recorded_test_hdf5(hdf5.path(), 110e3, testing::placed(recordings, truth),
                                 MeasuredCurves(truth.curves), time, 0.07);
        const auto infos = read_sensor_infos(hdf5.path()); // there are no metadata files
        REQUIRE(infos.size() == 3);
        CHECK(infos[2].attitude().coeffs() == read_sensor_infos(csv.path())[2].attitude().coeffs());
        CHECK(infos[2].placed_position() == read_sensor_infos(csv.path())[2].placed_position());
        const RecordedTest a = read_recorded_test(csv.path(), 110e3, read_sensor_infos(csv.path()),
                                                  {}),
                           b = read_recorded_test(hdf5.path(), 110e3, infos, {});
        CHECK(b.refused() == 0);
        REQUIRE(b.curves.size() == 101);
        for (std::size_t k = 0; k < 101; ++k) {
            CHECK(std::abs(b.curves[quantity::deviatoric_stress][k] -
                           truth.curves[quantity::deviatoric_stress][k]) < 1e-9);
            CHECK(b.curves[quantity::axial_strain][k] == truth.curves[quantity::axial_strain][k]);
            CHECK(b.curves[quantity::volumetric_strain][k] ==
                  truth.curves[quantity::volumetric_strain][k]);
        }
        REQUIRE(b.curves.rings() == truth.curves.rings());
        for (std::size_t r = 0; r < b.curves.rings(); ++r)
            CHECK(b.curves.ring(r) == truth.curves.ring(r));
        CHECK(b.clock.by_time.size() == 101);
        REQUIRE(a.trajectories[1].strain.size() == b.trajectories[1].strain.size());
        for (std::size_t k = 0; k < a.trajectories[1].strain.size(); ++k)
            CHECK((a.trajectories[1].displacement[k] - b.trajectories[1].displacement[k]).norm() <
                  1e-8); // the CSV file has seven digits
    }

    TEST_CASE("without metadata files the HDF5 file of each pressure gives the metadata of its "
              "sensors, also of one that other pressures do not have") {
        const TemporaryDirectory folder;
        const ModelRun truth = testing::steady_run();
        const auto recordings = record_sensors(truth, {}, 1);
        auto of_first = recordings;
        of_first.pop_back();
        of_first[0].info.clock_offset = 7;
        std::vector<double> time;
        for (const double strain : truth.curves[quantity::axial_strain])
            time.push_back(60 + 1.2e4 * strain);
        write_recorded_test_hdf5(folder.path(), 110e3, testing::placed(of_first, truth),
                                 MeasuredCurves(truth.curves), time, 0.07); // 110kPa precedes 55kPa
        write_recorded_test_hdf5(folder.path(), 55e3, testing::placed(recordings, truth),
                                 MeasuredCurves(truth.curves), time, 0.07);
        const auto infos = read_sensor_infos(folder.path());
        REQUIRE(infos.size() == 3);
        const RecordedTest a = read_recorded_test(folder.path(), 110e3, infos, {}),
                           b = read_recorded_test(folder.path(), 55e3, infos, {});
        CHECK(a.recordings[0].info.clock_offset == 7);
        CHECK(b.recordings[0].info.clock_offset == 0);
        CHECK(a.refused() == 1);
        CHECK(quality_control_report(a).find(
                  "sensor 3: refused: length: expected at least two samples, found 0") !=
              std::string::npos);
        CHECK(b.refused() == 0);
        CHECK(infos_of_test(folder.path(), 55e3, infos)[0].clock_offset == 0);
        write_sensor_info(folder / "rock_01.txt", of_first[0].info); // counts for all pressures
        CHECK(infos_of_test(folder.path(), 55e3, infos)[0].clock_offset == 7);
    }

    TEST_CASE("two files with the same data are refused, and so is a column map if no CSV file is "
              "read") {
        const TemporaryDirectory folder;
        const ModelRun truth = testing::steady_run();
        const auto recordings = record_sensors(truth, {}, 1);
        std::vector<double> time;
        for (const double strain : truth.curves[quantity::axial_strain])
            time.push_back(60 + 1.2e4 * strain);
        write_recorded_test_hdf5(folder.path(), 55e3, testing::placed(recordings, truth),
                                 MeasuredCurves(truth.curves), time, 0.07);
        const auto infos = read_sensor_infos(folder.path());
        const auto why = [&](const QualityControlSettings& settings) {
            return message_of<InputError>(
                [&] { (void)read_recorded_test(folder.path(), 55e3, infos, settings); });
        };
        const auto has = [](const std::string& text, const char* part) {
            INFO(text);
            return text.find(part) != std::string::npos;
        };
        CHECK(why({}).empty());
        CHECK(has(why({.columns = "map.txt"}), "--columns: expected no column map, because "));
        CHECK(has(why({.machine_columns = "map.txt"}),
                  "recordings.h5 is read and no test.csv, found 'map.txt'"));
        write_recorded_test(folder.path(), 55e3, testing::placed(recordings, truth),
                            MeasuredCurves(truth.curves));
        CHECK(has(why({}), "55kPa: expected recordings.csv or recordings.h5, found both"));
        std::filesystem::remove(folder / "55kPa" / "recordings.csv");
        CHECK(has(why({}), "55kPa: expected test.csv or /bench in recordings.h5, found both"));
        write_recordings_hdf5(folder / "55kPa" / "recordings.h5", recordings);
        CHECK(why({}).empty()); // sensors in recordings.h5, the machine in test.csv
        std::filesystem::remove(folder / "55kPa" / "test.csv");
        CHECK(has(why({}),
                  "recordings.h5: expected a group /bench, or test.csv beside it, found neither"));
    }

    TEST_CASE("the deviatoric stress is the force over the current area") {
        const TemporaryDirectory folder;
        TestCurves curves;
        const auto first = curves.add_row(), p = curves.add_row();
        first[quantity::axial_strain] = first[quantity::volumetric_strain] = 0;
        first[quantity::deviatoric_stress] = 0;
        p[quantity::axial_strain] = 0.1;
        p[quantity::volumetric_strain] = -0.05;
        p[quantity::deviatoric_stress] = 2e5;
        Hdf5File::create(folder / "a.h5").close();
        write_machine_record(folder / "a.h5", curves, {0, 1}, 0.018, 55e3);
        const Hdf5File file = Hdf5File::open(folder / "a.h5");
        CHECK(file.read<double>("/bench/force")[1] == about(2e5 * 0.018 * 1.05 / 0.9)); // N
        CHECK(file.read<double>("/bench/confining") == std::vector<double>{55e3, 55e3});
        CHECK(read_machine_record(folder / "a.h5", 55e3).curves[quantity::deviatoric_stress][1] ==
              about(2e5));
    }

    TEST_CASE("measurements of a machine with another pressure, shape or order, or without an "
              "area, are refused with the location") {
        const auto why = [](auto&& change) {
            const TemporaryDirectory folder;
            const ModelRun truth = testing::steady_run();
            std::vector<double> time;
            for (const double strain : truth.curves[quantity::axial_strain])
                time.push_back(1.2e4 * strain);
            Hdf5File::create(folder / "a.h5").close();
            write_machine_record(folder / "a.h5", truth.curves, time, 0.018, 55e3);
            {
                Hdf5File file = Hdf5File::open_to_write(folder / "a.h5");
                change(file);
                file.close();
            }
            return message_of<InputError>(
                [&] { (void)read_machine_record(folder / "a.h5", 55e3); });
        };
        const auto put = [](const char* name, std::vector<double> numbers) {
            return [name, numbers](Hdf5File& file) {
                if (file.has(name)) file.remove(name);
                file.write(name, std::span<const double>(numbers));
            };
        };
        const auto has = [](const std::string& text, const char* part) {
            INFO(text);
            return text.find(part) != std::string::npos;
        };
        CHECK(why([](Hdf5File&) {}).empty());
        CHECK(has(why(put("/bench/confining", std::vector<double>(101, 55.0))),
                  "a.h5: /bench/confining: expected a median of 55000 Pa within 5 %, found 55"));
        CHECK(has(why(put("/bench/force", std::vector<double>(7, 1.0))),
                  "/bench/force: expected 101 numbers, as many as in time, found 7"));
        CHECK(has(why(put("/bench/strain", std::vector<double>(101, 0.0))),
                  "/bench/strain[1]: expected increasing numbers, found 0"));
        CHECK(has(why(put("/bench/force", std::vector<double>(101, std::nan("")))),
                  "/bench/force[0]: expected a number, found nan"));
        CHECK(has(why(put("/bench/ring_radius", std::vector<double>(101, 0.07))),
                  "/bench/ring_radius: expected 101 rows"));
        CHECK(has(why([](Hdf5File& file) { file.set_attribute<double>("/bench", "area", 0); }),
                  "area: expected a number above 0 (m2), found 0"));
        std::vector<double> percent(101, 0);
        for (std::size_t k = 1; k < 101; ++k) percent[k] = 0.25 * static_cast<double>(k);
        CHECK(has(why(put("/bench/strain", percent)),
                  "/bench/strain[4]: expected a number below 1, found 1: is it in per cent?"));
        CHECK(has(why([](Hdf5File& file) { file.remove("/bench/force"); }),
                  "/bench/force: expected numbers, found none"));
        const auto put_shape = [](const char* name, std::vector<double> numbers,
                                  const Hdf5File::Shape& shape) {
            return [=](Hdf5File& file) {
                file.remove(name);
                file.write(name, std::span<const double>(numbers), shape);
            };
        };
        CHECK(has(why(put_shape("/bench/time", {1}, {})),
                  "/bench/time: expected a one-dimensional array of numbers, found a scalar"));
        CHECK(has(why(put_shape("/bench/time", percent, {101, 1})),
                  "/bench/time: expected a one-dimensional array of numbers, found 101 x 1"));
        CHECK(has(why(put_shape("/bench/ring_radius", {1}, {})),
                  "/bench/ring_radius: expected 101 rows of ring radii, found a scalar"));
    }
}

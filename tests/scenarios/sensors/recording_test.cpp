#include "engine/errors.hpp"
#include "engine/io/column_map.hpp"
#include "engine/io/hdf5.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/random.hpp"
#include "scenarios/sensors/recording.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

namespace {

/// Two rocks. The sensor of the second has a rotated mounting and other units; the first has no
/// displacement.
std::vector<Recording> two_recordings() {
    std::vector<Recording> all(2);
    for (unsigned id : {1u, 2u}) {
        Recording& r = all[id - 1];
        Random random(5, id);
        r.info.id = id;
        for (std::size_t k = 0; k < 7; ++k) {
            r.time.push_back(0.1 * static_cast<double>(k));
            r.sequence.push_back(k);
            r.strain.push_back(1e-3 * static_cast<double>(k));
            r.force.push_back(random.normal() * random.direction());
            r.rate.push_back(random.normal() * random.direction());
            r.attitude.push_back(random.rotation());
            if (id == 2) r.displacement.push_back(random.direction());
        }
    }
    const Quat askew = Random(6, 1).rotation();
    SensorInfo& info = all[1].info;
    std::tie(info.mounting_w, info.mounting_x, info.mounting_y, info.mounting_z) =
        std::tuple(askew.w(), askew.x(), askew.y(), askew.z());
    info.force_unit = std::string("g");
    info.rate_unit = "deg/s";
    return all;
}

double apart(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    REQUIRE(a.size() == b.size());
    double most = 0;
    for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, (a[k] - b[k]).norm());
    return most;
}

/// The same with the other channels of a SmartRock for the second rock, in other units.
std::vector<Recording> full_recordings() {
    auto all = two_recordings();
    Recording& r = all[1];
    Random random(7, 1);
    for (std::size_t k = 0; k < r.size(); ++k) {
        r.field.push_back(48e-6 * random.direction());
        r.temperature.push_back(293 + 0.1 * static_cast<double>(k));
        r.battery.push_back(90 - static_cast<double>(k));
        r.phase.push_back(0.25 * static_cast<double>(k));
    }
    r.info.field_unit = std::string("mG");
    r.info.temperature_unit = std::string("F");
    r.info.battery_unit = std::string("%");
    return all;
}

void check_full(const Recording& read, const Recording& written, double tolerance) {
    CHECK(apart(read.force, written.force) < tolerance);
    CHECK(apart(read.rate, written.rate) < tolerance);
    CHECK(apart(read.field, written.field) < 48e-6 * tolerance);
    REQUIRE(read.temperature.size() == 7);
    CHECK(read.temperature[6] == about(written.temperature[6]).epsilon(1e-6));
    CHECK(read.battery == written.battery);
    CHECK(read.phase == written.phase);
    CHECK(read.sequence == written.sequence);
}

} // namespace

TEST_SUITE("sensors/recording") {
    TEST_CASE("recordings written to HDF5 are read back the same, whatever the units and the "
              "mounting") {
        const TemporaryDirectory directory;
        const auto written = two_recordings();
        write_recordings_hdf5(directory / "a.h5", written);
        const auto read =
            read_recordings_hdf5(directory / "a.h5", {written[0].info, written[1].info});
        REQUIRE(read.size() == 2);
        for (std::size_t s = 0; s < 2; ++s) {
            CHECK(read[s].time == written[s].time);
            CHECK(read[s].strain == written[s].strain);
            CHECK(read[s].sequence == written[s].sequence);
            CHECK(apart(read[s].force, written[s].force) < 1e-14);
            CHECK(apart(read[s].rate, written[s].rate) < 1e-14);
            CHECK(apart(read[s].displacement, written[s].displacement) == 0);
            REQUIRE(read[s].attitude.size() == 7);
            CHECK(read[s].attitude[3].coeffs() == written[s].attitude[3].coeffs());
        }
        // the file has the units of the sensor
        CHECK(Hdf5File::open(directory / "a.h5").text_attribute("/sensors/2", "accel_unit") == "g");
        CHECK(Eigen::Vector3d::Map(
                  Hdf5File::open(directory / "a.h5").read<double>("/sensors/2/accel").data())
                  .norm() == about(written[1].force[0].norm() / standard_gravity));
    }

    TEST_CASE(
        "an HDF5 file with an unknown id, a wrong shape or damage is refused with the location") {
        const TemporaryDirectory directory;
        const auto written = two_recordings();
        const auto path = directory / "b.h5";
        write_recordings_hdf5(path, written);
        CHECK_THROWS_WITH_AS(
            (void)read_recordings_hdf5(path, {written[0].info}),
            doctest::Contains("/sensors/2: expected the id of a metadata file, found 2"),
            InputError);
        CHECK_THROWS_AS(
            (void)read_recordings_hdf5(path, {written[0].info, written[1].info, written[0].info}),
            InputError);
        {
            Hdf5File file = Hdf5File::open_to_write(path);
            file.remove("/sensors/1/gyro");
            const std::vector<double> few(9, 0.0);
            file.write("/sensors/1/gyro", std::span<const double>(few), {3, 3});
            file.close();
        }
        CHECK_THROWS_WITH_AS((void)read_recordings_hdf5(path, {written[0].info, written[1].info}),
                             doctest::Contains("/sensors/1/gyro: expected 7 x 3, found 3 x 3"),
                             InputError);
        std::filesystem::resize_file(path, 1000);
        CHECK_THROWS_AS((void)read_recordings_hdf5(path, {written[0].info, written[1].info}),
                        OutputError);
        // a scalar is neither an array of times nor a channel
        for (const char* dataset : {"time", "gyro"}) {
            write_recordings_hdf5(path, {written[0]});
            Hdf5File file = Hdf5File::open_to_write(path);
            const std::string name = std::string("/sensors/1/") + dataset;
            const std::vector<double> one(1, 0.0);
            file.remove(name);
            file.write(name, std::span<const double>(one), {});
            file.close();
            CHECK_THROWS_WITH_AS((void)read_recordings_hdf5(path, {written[0].info}),
                                 doctest::Contains("found a scalar"), InputError);
        }
        // a rock without a group has an empty recording, which quality control refuses
        write_recordings_hdf5(path, {written[0]});
        CHECK(read_recordings_hdf5(path, {written[0].info, written[1].info})[1].size() == 0);
    }

    TEST_CASE("magnetometer, temperature, battery and phase written to CSV and HDF5 are read back "
              "the same, each in its unit") {
        const TemporaryDirectory directory;
        const auto written = full_recordings();
        write_recordings_hdf5(directory / "a.h5", written);
        check_full(read_recordings_hdf5(directory / "a.h5", {written[0].info, written[1].info})[1],
                   written[1], 1e-14);
        CHECK(Hdf5File::open(directory / "a.h5").text_attribute("/sensors/2", "mag_unit") == "mG");
        CHECK(Eigen::Vector3d::Map(
                  Hdf5File::open(directory / "a.h5").read<double>("/sensors/2/mag").data())
                  .norm() == about(480));
        write_recordings(directory / "a.csv", {written[1]}, {});
        check_full(read_recordings(directory / "a.csv", {written[1].info})[0], written[1], 1e-5);
    }

    TEST_CASE("an HDF5 file contains the metadata, and contradicting units are refused") {
        const TemporaryDirectory directory;
        auto written = full_recordings();
        const auto path = directory / "a.h5";
        written.push_back(written[0]);
        written[2].info.id = 10;
        write_recordings_hdf5(path, written);
        const auto infos = read_sensor_infos_hdf5(path);
        REQUIRE(infos.size() == 3);
        CHECK(infos[2].id == 10); // after 2
        CHECK(infos[1].id == 2);
        CHECK(infos[1].mounting_x == written[1].info.mounting_x);
        CHECK(infos[1].force_unit == "g");
        CHECK(infos[1].battery_unit == "%");
        SensorInfo other = infos[1];
        other.rate_unit = "rad/s";
        CHECK_THROWS_WITH_AS(
            (void)read_recordings_hdf5(path, {infos[0], other, infos[2]}),
            doctest::Contains(
                "/sensors/2: gyro_unit: expected rad/s as in the metadata, found deg/s"),
            InputError);
        Hdf5File file = Hdf5File::open_to_write(path);
        file.set_attribute<double>("/sensors/1", "sampling_rate", -5);
        file.close();
        CHECK_THROWS_WITH_AS(
            (void)read_sensor_infos_hdf5(path),
            doctest::Contains(
                "/sensors/1: --sampling-rate: expected a number above 0 and at most 1000000 "
                "(Hz), found \"-5\""),
            InputError);
    }

    TEST_CASE("an HDF5 file keeps the metadata of a sensor that recorded nothing") {
        const TemporaryDirectory directory;
        auto written = two_recordings();
        Recording none;
        none.info.id = 3;
        none.info.clock_offset = 5;
        written.push_back(none);
        write_recordings_hdf5(directory / "a.h5", written);
        const auto infos = read_sensor_infos_hdf5(directory / "a.h5");
        REQUIRE(infos.size() == 3);
        CHECK(infos[2].clock_offset == 5);
        CHECK(read_recordings_hdf5(directory / "a.h5", infos)[2].size() == 0);
    }

    TEST_CASE("flags and counts in HDF5 must be non-negative whole numbers of any type, and a flag "
              "that is not a number counts as 0") {
        const TemporaryDirectory directory;
        const auto written = two_recordings();
        const auto path = directory / "a.h5";
        const auto read = [&](const char* dataset, const std::vector<double>& numbers) {
            write_recordings_hdf5(path, {written[0]});
            Hdf5File file = Hdf5File::open_to_write(path);
            if (file.has(dataset)) file.remove(dataset);
            file.write(dataset, std::span<const double>(numbers));
            file.close();
            return read_recordings_hdf5(path, {written[0].info})[0];
        };
        const double none = std::nan("");
        CHECK(read("/sensors/1/flags", {0, none, 2, 0, 0, 0, 0}).flagged ==
              std::vector<double>{written[0].time[2]});
        CHECK_THROWS_WITH_AS(
            (void)read("/sensors/1/flags", {0, 0, -1, 0, 0, 0, 0}),
            doctest::Contains(
                "/sensors/1/flags[2]: expected a non-negative whole number, found -1"),
            InputError);
        CHECK_THROWS_WITH_AS(
            (void)read("/sensors/1/sequence", {0, 1, 2, none, 4, 5, 6}),
            doctest::Contains("/sensors/1/sequence[3]: expected a non-negative whole number"),
            InputError);
        CHECK_THROWS_WITH_AS((void)read("/sensors/1/sequence", {0, 1, 2.5, 3, 4, 5, 6}),
                             doctest::Contains("found 2.5"), InputError);
    }

    TEST_CASE("samples that the sensor flags do not count as the first sample without a number, in "
              "CSV and in HDF5") {
        const TemporaryDirectory directory;
        SensorInfo info;
        info.id = 7;
        write_whole(directory / "a.csv",
                    "t,id,flags,ax,ay,az\n0,7,0,0,0,9\nnan,7,1,,0,9\n2,7,0,0,inf,9\n3,7,0,,0,9\n");
        const auto of_csv = read_recordings(directory / "a.csv", {info})[0];
        CHECK(of_csv.first_without.at("ax ay az").ends_with("a.csv:4"));
        CHECK_FALSE(of_csv.first_without.contains("t"));
        auto written = two_recordings();
        written[0].time[1] = written[0].rate[1].x() = written[0].rate[4].x() = std::nan("");
        write_recordings_hdf5(directory / "a.h5", {written[0]});
        CHECK(read_recordings_hdf5(directory / "a.h5", {written[0].info})[0]
                  .first_without.at("t")
                  .ends_with("a.h5: /sensors/1/time[1]"));
        const std::vector<double> flags{0, 1, 0, 0, 0, 0, 0};
        Hdf5File file = Hdf5File::open_to_write(directory / "a.h5");
        file.write("/sensors/1/flags", std::span<const double>(flags));
        file.close();
        const auto of_hdf5 = read_recordings_hdf5(directory / "a.h5", {written[0].info})[0];
        CHECK(of_hdf5.first_without.at("gx gy gz").ends_with("a.h5: /sensors/1/gyro[4]"));
        CHECK_FALSE(of_hdf5.first_without.contains("t"));
    }

    TEST_CASE("a CSV file of another make, read with a column map, gives the same recording, "
              "whatever the units of the metadata") {
        const TemporaryDirectory directory;
        SensorInfo info;
        info.id = 7;
        info.force_unit = std::string("g"); // of own.csv
        write_whole(directory / "own.csv",
                    "t,id,ax,ay,az,gx,gy,gz,temp\n0.25,7,0.1,-0.2,0.97,0.5,0.25,-1,20\n");
        write_whole(directory / "map.txt",
                    "delimiter = semicolon\ndecimal = comma\nt = \"t [ms]\", ms\nid = node\nax = "
                    "-Y, mg\nay = X, mg\naz = Z, mg\n"
                    "gx = -P, deg/s\ngy = R, deg/s\ngz = Q, deg/s\ntemp = T, F\n");
        write_whole(directory / "other.csv",
                    "node;t "
                    "[ms];X;Y;Z;R;P;Q;T;comment\n7;250;-200;-100;970;14,3239448782706;-28,"
                    "6478897565412;-57,2957795130823;68;fine\n");
        const auto own = read_recordings(directory / "own.csv", {info}),
                   other =
                       read_recordings(directory / "other.csv", {info},
                                       read_column_map(directory / "map.txt", recording_columns()));
        REQUIRE(other[0].size() == 1);
        CHECK(other[0].time[0] == about(0.25));
        CHECK((other[0].force[0] - own[0].force[0]).norm() < 1e-12);
        CHECK((other[0].rate[0] - own[0].rate[0]).norm() < 1e-12);
        CHECK(other[0].temperature[0] == about(own[0].temperature[0]));
        // a vector with a unit for some of its components only
        write_whole(directory / "map.txt",
                    "delimiter = semicolon\ndecimal = comma\nt = \"t [ms]\", ms\nid = node\nax = "
                    "X, mg\nay = Y\naz = Z, mg\n");
        CHECK_THROWS_WITH_AS(
            (void)read_recordings(directory / "other.csv", {info},
                                  read_column_map(directory / "map.txt", recording_columns())),
            doctest::Contains("map.txt:6: ay: expected a unit, as for az, found none"), InputError);
    }

    TEST_CASE("samples that a sensor flags are left out in all channels, except for ignored bits") {
        const TemporaryDirectory directory;
        SensorInfo info;
        info.id = 7;
        write_whole(directory / "a.csv", "t,id,seq,flags,ax,ay,az,temp\n0,7,0,0,1,0,9,20\n1,7,1,4,"
                                         "99,99,99,20\n2,7,2,,2,0,9,\n3,7,3,1,99,99,99,20\n");
        auto read = read_recordings(directory / "a.csv", {info})[0];
        CHECK(read.time == std::vector<double>{0, 2});
        CHECK(read.sequence == std::vector<std::uint64_t>{0, 2});
        CHECK(read.force[1].x() == 2);
        CHECK(read.flagged == std::vector<double>{1, 3});
        REQUIRE(read.temperature.size() == 2);
        CHECK(read.first_without.at("temp").ends_with("a.csv:4"));
        info.flags_ignored = 4;
        read = read_recordings(directory / "a.csv", {info})[0];
        CHECK(read.time == std::vector<double>{0, 1, 2});
        CHECK(read.flagged == std::vector<double>{3});
        write_whole(directory / "a.csv", "t,id,flags\n0,7,-1\n");
        CHECK_THROWS_WITH_AS(
            (void)read_recordings(directory / "a.csv", {info}),
            doctest::Contains("a.csv:2: flags: expected a non-negative whole number, found -1"),
            InputError);
    }

    TEST_CASE("one of anything is the same amount in each of its units") {
        const auto in_units = [](const std::string& name,
                                 const std::vector<std::pair<std::string, double>>& amounts) {
            const auto& columns = recording_columns();
            const auto column = std::ranges::find(columns, name, &KnownColumn::name);
            REQUIRE(column != columns.end());
            for (const auto& [unit, amount] : amounts) {
                CAPTURE(unit);
                const auto found = std::ranges::find(column->units, unit, &ColumnUnit::name);
                REQUIRE(found != column->units.end());
                CHECK(found->scale * amount + found->offset == about(1).epsilon(1e-12));
            }
        };
        in_units("t", {{"s", 1}, {"ms", 1e3}, {"us", 1e6}, {"ns", 1e9}, {"min", 1.0 / 60}});
        in_units("strain", {{"1", 1}, {"%", 100}});
        in_units("phase", {{"cycles", 1}, {"deg", 360}, {"rad", 2 * pi}});
        in_units("ay", {{"m/s2", 1}, {"g", 1 / 9.80665}, {"mg", 1e3 / 9.80665}});
        in_units("gz", {{"rad/s", 1}, {"mrad/s", 1e3}, {"deg/s", 180 / pi}});
    }
}

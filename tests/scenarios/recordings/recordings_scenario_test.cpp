// The scenario recordings as a user starts it: judges the shipped recordings, and makes a folder of
// recordings from a CSV file of another make.

#include "engine/assets.hpp"
#include "engine/io/column_map.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/recordings/guess_columns.hpp"
#include "scenarios/recordings/recorded_test.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/faults/process.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <fstream>

using namespace bris;

namespace {

namespace fs = std::filesystem;

/// The shipped recordings at 55 kPa as another program would export them: semicolons, decimal
/// commas, milliseconds, accelerations in g, rates in degrees per second, strain in per cent, two
/// lines before the names of the columns.
std::string foreign(const std::vector<Recording>& recordings) {
    std::string text = "Logger 4.2\nexported;2024-05-07\n"
                       "Timestamp (ms);Sensor ID;Acc X (g);Acc Y (g);Acc Z (g);Gyro_X [\u00b0/s];"
                       "Gyro_Y [\u00b0/s];Gyro_Z [\u00b0/s];Axial strain [%];Remark\n";
    for (std::size_t k = 0; k < recordings.front().size(); ++k)
        for (const Recording& r : recordings) {
            std::string row = fmt::format("{:.6f};{};", 1e3 * r.time[k], r.info.id);
            for (const double x : r.force[k]) row += fmt::format("{:.9g};", x / standard_gravity);
            for (const double x : r.rate[k]) row += fmt::format("{:.9g};", x * 180 / pi);
            row += fmt::format("{:.9g};1\n", 100 * r.strain[k]);
            std::ranges::replace(row, '.', ',');
            text += row;
        }
    return text;
}

std::string foreign_machine(const std::vector<TriaxialPoint>& points) {
    std::string text = "Axial strain (%),q (kPa),Volumetric strain (%)\n";
    for (const TriaxialPoint& p : points)
        text += fmt::format("{:.9g},{:.9g},{:.9g}\n", 100 * p.axial_strain,
                            1e-3 * p.deviatoric_stress, 100 * p.volumetric_strain);
    return text;
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

} // namespace

TEST_SUITE("recordings/recordings_scenario") {
    TEST_CASE("the shipped recordings are judged in seconds: report, plots of every channel, and "
              "what is observable") {
        const TemporaryDirectory folder;
        const Outcome outcome = run_process({"recordings", (assets_folder() / "smartrock").string(),
                                             "--out", (folder / "out").string(), "--quiet"});
        CAPTURE(outcome.err);
        REQUIRE(outcome.code == 0);
        CHECK(outcome.seconds < 60);
        CHECK(
            has(outcome.out, "110kPa: all 10 sensors are accepted; the test machine is accepted"));
        const std::string report = read_whole(folder / "out/quality_control.txt");
        for (const char* part : {"55kPa\n", "165kPa\n", "yaw", "  observable", "tilt"})
            CHECK(has(report, part));
        for (const char* pressure : {"55kPa", "110kPa", "165kPa"})
            for (const char* plot : {"sensors.png", "machine.png"})
                CHECK(fs::file_size(folder / "out" / pressure / plot) > 10'000);
        CHECK(has(read_whole(folder / "out/summary.json"), "\"165kPa_sensors_accepted\": 10"));
    }

    TEST_CASE("a test that cannot be read does not keep the others from being judged") {
        const TemporaryDirectory folder;
        const fs::path own = folder / "own", out = folder / "out";
        fs::copy(assets_folder() / "smartrock", own, fs::copy_options::recursive);
        fs::remove(own / "110kPa/test.csv");
        const Outcome outcome =
            run_process({"recordings", own.string(), "--out", out.string(), "--quiet"});
        CHECK(outcome.code == 4);
        CHECK(has(outcome.err, "test.csv"));
        CHECK(has(outcome.out, "165kPa: all 10 sensors are accepted"));
        CHECK(has(read_whole(out / "quality_control.txt"), "165kPa\n"));
        CHECK(has(read_whole(out / "summary.json"), "\"55kPa_sensors_accepted\": 10"));
    }

    TEST_CASE("attitudes that are recorded become those of the start") {
        const TemporaryDirectory folder;
        write_whole(folder / "a.csv", "t,id,ax,ay,az,qw,qx,qy,qz\n0.01,1,0,0,9.8,0.6,0,0,0.8\n"
                                      "0.02,1,0,0,9.8,0.6,0,0,0.8\n");
        const Outcome outcome = run_process({"recordings", "--new", (folder / "a.csv").string(),
                                             "--out", (folder / "out").string()});
        CHECK(outcome.code == 0);
        CHECK(has(outcome.out, "from qw qx qy qz in the first sample"));
        CHECK(read_sensor_info(folder / "out/rock_01.txt").qz == about(0.8));
    }

    TEST_CASE("a CSV file of another make becomes a folder of recordings with the same numbers") {
        const TemporaryDirectory folder;
        const fs::path example = assets_folder() / "smartrock";
        const auto infos = read_sensor_infos(example);
        const RecordedTest original = read_recorded_test(example, 55e3, infos, {});
        write_whole(folder / "export.csv", foreign(original.recordings));
        write_whole(folder / "machine.csv", foreign_machine(original.measured));
        const std::string made = folder / "made";
        const Outcome outcome =
            run_process({"recordings", "--new", folder / "export.csv", "--new-machine",
                         folder / "machine.csv", "--out", made});
        CAPTURE(outcome.err);
        REQUIRE(outcome.code == 0);
        for (const char* note :
             {"The names of the columns stand in line 3; cells are separated by a semicolon, "
              "decimals by a comma.",
              "t is \"Timestamp (ms)\" in ms.", "id is \"Sensor ID\".", "az is \"Acc Z (g)\" in g.",
              "in deg/s.", "strain is \"Axial strain [%]\" in %.",
              "Not recognised and ignored: \"Remark\".",
              "deviatoric_stress_Pa is \"q (kPa)\" in kPa.", "10 sensors", "Still to be given"})
            CHECK_MESSAGE(has(outcome.out, note), note << "\n" << outcome.out);
        const QualityControlSettings settings{.columns = folder / "made/columns.txt",
                                              .machine_columns =
                                                  folder / "made/machine_columns.txt"};
        auto own = read_sensor_infos(made);
        REQUIRE(own.size() == infos.size());
        CHECK(own[3].sampling_rate == about(infos[3].sampling_rate).epsilon(0.01));
        CHECK(read_recorded_test(made, 55e3, own, settings).refused() == 10); // without positions
        for (std::size_t k = 0; k < own.size(); ++k) {
            own[k].set_pose(infos[k].position(), own[k].attitude());
            write_sensor_info(fs::path(made) / fmt::format("rock_{:02}.txt", own[k].id), own[k]);
        }
        const RecordedTest back = read_recorded_test(made, 55e3, own, settings);
        REQUIRE(back.recordings.size() == original.recordings.size());
        for (std::size_t r = 0; r < back.recordings.size(); ++r) {
            const Recording &a = original.recordings[r], &b = back.recordings[r];
            REQUIRE(a.size() == b.size());
            for (std::size_t k = 0; k < a.size(); ++k) {
                CHECK((a.force[k] - b.force[k]).norm() < 1e-7);
                CHECK((a.rate[k] - b.rate[k]).norm() < 1e-8);
                CHECK(std::abs(a.strain[k] - b.strain[k]) < 1e-9);
            }
        }
        CHECK(back.measured.back().deviatoric_stress ==
              about(original.measured.back().deviatoric_stress));
        CHECK(back.refused() == 0);
        // judged by one command, which finds the maps; and never overwritten
        const Outcome judged = run_process({"recordings", made, "--out", folder / "judged"});
        CHECK(judged.code == 0);
        CHECK(has(judged.out, "55kPa: all 10 sensors are accepted"));
        const Outcome again =
            run_process({"recordings", "--new", folder / "export.csv", "--out", made});
        CHECK(again.code == 2);
        CHECK(has(again.err, "--new: expected a folder without recordings, found '"));
    }

    TEST_CASE("a second test goes into the same folder and keeps what was completed by hand, and a "
              "failure leaves nothing behind") {
        const TemporaryDirectory folder;
        const fs::path csv = folder / "a.csv", out = folder / "out";
        write_whole(csv, "t,id,ax,ay,az\n0.01,1,0,0,9.8\n0.02,1,0,0,9.8\n0.03,1,0,0,9.8\n");
        const auto make = [&](const char* pressure, std::vector<std::string> more = {}) {
            std::vector<std::string> words{"recordings",           "--new", csv, "--out", out,
                                           "--confining-pressure", pressure};
            words.insert(words.end(), more.begin(), more.end());
            return run_process(words);
        };
        const Outcome failed = make("55e3", {"--new-machine", folder / "none.csv"});
        CHECK(failed.code == 4);
        CHECK_FALSE(fs::exists(out));
        REQUIRE(make("55e3").code == 0);
        SensorInfo own = read_sensor_info(out / "rock_01.txt");
        own.z = 0.25;
        write_sensor_info(out / "rock_01.txt", own);
        const Outcome second = make("110e3");
        CHECK(second.code == 0);
        CHECK(has(second.out, "columns.txt, which is kept"));
        CHECK(read_sensor_info(out / "rock_01.txt").z == 0.25);
        CHECK(read_whole(out / "110kPa/recordings.csv") == read_whole(csv));
    }

    TEST_CASE("a byte order mark, a line of units, columns of text and several sensors do not "
              "mislead the guess") {
        const TemporaryDirectory folder;
        std::string text = "\xef\xbb\xbftimestamp,t,id,ax,ay,az,\x1b[31mnote\n"
                           ",ms,,m/s2,m/s2,m/s2,\n";
        for (int k = 0; k < 40; ++k)
            for (int id = 1; id <= 10; ++id) // a hundred samples per second of each of ten
                text += fmt::format("2026-11-27 10:00,{},{},0,0.1,9.8,fine\n", 10 * k + 1, id);
        write_whole(folder / "a.csv", text);
        const GuessedMap guess = guess_columns(folder / "a.csv", recording_columns());
        for (const char* line :
             {"first_line = 3\n", "t = \"t\", ms\n", "id = \"id\"\n", "az = \"az\", m/s2\n"})
            CHECK_MESSAGE(has(guess.map, line), line << "\n" << guess.map);
        CHECK(std::ranges::none_of(guess.notes, [](const std::string& note) {
            return note.find('\x1b') != std::string::npos;
        }));
    }

    TEST_CASE("columns are recognised by usual names, and units without a name by size") {
        const TemporaryDirectory folder;
        const auto map_of = [&](const std::string& text) {
            write_whole(folder / "a.csv", text);
            return guess_columns(folder / "a.csv", recording_columns()).map;
        };
        const std::string plain = map_of("time,node,accX,accY,accZ,wx,wy,wz,temp_C\n"
                                         "0,1,0.01,0.02,-0.99,0,0,0,21\n"
                                         "0.005,1,0.01,0.02,-0.99,0,0,0,21\n");
        for (const char* line : {"t = \"time\", s\n", "id = \"node\"\n", "az = \"accZ\", g\n",
                                 "gx = \"wx\", rad/s\n", "temp = \"temp_C\", C\n"})
            CHECK_MESSAGE(has(plain, line), line << "\n" << plain);
        const std::string tabs =
            map_of("Time\tID\tX Accel\tY Accel\tZ Accel\tQuat W\tQuat X\tQuat Y\t"
                   "Quat Z\n5\t2\t10\t-20\t1001\t1\t0\t0\t0\n"
                   "10\t2\t10\t-20\t1001\t1\t0\t0\t0\n");
        for (const char* line :
             {"delimiter = tab\n", "t = \"Time\", ms\n", "ax = \"X Accel\", mg\n",
              "qw = \"Quat W\"\n", "qz = \"Quat Z\"\n"})
            CHECK_MESSAGE(has(tabs, line), line << "\n" << tabs);
        write_whole(folder / "map.txt", tabs); // a map that the reader of maps accepts
        CHECK(read_column_map(folder / "map.txt", recording_columns()).columns.size() == 9);
        const Outcome none = run_process({"recordings", "--new", folder / "a.csv", "--new-machine",
                                          folder / "a.csv", "--out", folder / "out"});
        CHECK(none.code == 2);
        CHECK(has(none.err, "expected a column that looks like axial_strain, found none"));
        CHECK_FALSE(fs::exists(folder / "out/55kPa"));
        write_whole(folder / "prose.csv", "no table\nat all\n");
        const Outcome prose =
            run_process({"recordings", "--new", folder / "prose.csv", "--out", folder / "out"});
        CHECK(prose.code == 2);
        CHECK(has(prose.err, "expected a line of column names above lines of numbers"));
    }
}

// The scenario recordings as a user starts it: judges the shipped recordings, and makes a folder of
// recordings from a CSV file of another make.

#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "engine/io/column_map.hpp"
#include "engine/io/hdf5.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/records/guess_columns.hpp"
#include "scenarios/records/machine_hdf5.hpp"
#include "scenarios/records/recorded_test.hpp"
#include "tests/about.hpp"
#include "tests/engine/io/foreign_text.hpp"
#include "tests/scenarios/faults/process.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

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

std::string foreign_machine(const TestCurves& curves) {
    std::string text = "Axial strain (%),q (kPa),Volumetric strain (%)\n";
    for (std::size_t k = 0; k < curves.size(); ++k)
        text += fmt::format("{:.9g},{:.9g},{:.9g}\n", 100 * curves[quantity::axial_strain][k],
                            1e-3 * curves[quantity::deviatoric_stress][k],
                            100 * curves[quantity::volumetric_strain][k]);
    return text;
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

} // namespace

TEST_SUITE("sensors/recordings_scenario") {
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
        write_whole(folder / "machine.csv", foreign_machine(original.curves));
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
            own[k].set_placed(infos[k].placed_position(), infos[k].placed_attitude());
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
        CHECK(back.curves[quantity::deviatoric_stress].back() ==
              about(original.curves[quantity::deviatoric_stress].back()));
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

    TEST_CASE("columns are recognised by usual names; a file without a table, or without what is "
              "needed, is refused") {
        const TemporaryDirectory folder;
        const auto guess_of = [&](const std::string& text) {
            write_whole(folder / "a.csv", text);
            return guess_columns(folder / "a.csv", recording_columns());
        };
        const std::string plain = guess_of("time,node,accX,accY,accZ,wx_dps,wy_dps,wz_dps,temp_C\n"
                                           "0,1,0.01,0.02,-0.99,0,0,0,21\n"
                                           "0.005,1,0.01,0.02,-0.99,0,0,0,21\n")
                                      .map;
        for (const char* line : {"t = \"time\", s\n", "id = \"node\"\n", "az = \"accZ\", g\n",
                                 "gx = \"wx_dps\", deg/s\n", "temp = \"temp_C\", C\n"})
            CHECK_MESSAGE(has(plain, line), line << "\n" << plain);
        const std::string tabs =
            guess_of("Time/ms\tID\tX Accel\tY Accel\tZ Accel\tQuat W\tQuat X\tQuat Y\t"
                     "Quat Z\n5\t2\t10\t-20\t1001\t1\t0\t0\t0\n"
                     "10\t2\t10\t-20\t1001\t1\t0\t0\t0\n")
                .map;
        for (const char* line :
             {"delimiter = tab\n", "t = \"Time/ms\", ms\n", "ax = \"X Accel\", mg\n",
              "qw = \"Quat W\"\n", "qz = \"Quat Z\"\n"})
            CHECK_MESSAGE(has(tabs, line), line << "\n" << tabs);
        write_whole(folder / "map.txt", tabs); // a map that the reader of maps accepts
        CHECK(read_column_map(folder / "map.txt", recording_columns()).columns.size() == 9);
        const Outcome none = run_process({"recordings", "--new", folder / "a.csv", "--new-machine",
                                          folder / "a.csv", "--out", folder / "out"});
        CHECK(none.code == 2);
        CHECK(
            has(none.err,
                "expected a column that looks like axial_strain, deviatoric_stress_Pa, found none "
                "among \"Time/ms\", \"ID\""));
        CHECK_FALSE(fs::exists(folder / "out"));
        write_whole(folder / "prose.csv", "no table\nat all\n");
        const Outcome prose =
            run_process({"recordings", "--new", folder / "prose.csv", "--out", folder / "out"});
        CHECK(prose.code == 2);
        CHECK(has(prose.err, "expected lines of numbers separated by commas"));
    }

    TEST_CASE("the unit of time that a header states is the unit: the sampling rate is right") {
        const TemporaryDirectory folder;
        for (const auto& [title, rate] : {std::pair{"Time (seconds)", 1.0 / 12},
                                          {"Time (milliseconds)", 1e3 / 12},
                                          {"Time", 1.0 / 12}}) {
            std::string text = std::string(title) + ",Node,ax,ay,az\n";
            for (int k = 0; k < 6; ++k) text += fmt::format("{},1,0.01,0.02,9.81\n", 12 * k);
            write_whole(folder / "a.csv", text);
            const auto out = folder / fmt::format("out_{}", std::string(title).size());
            const Outcome outcome =
                run_process({"recordings", "--new", folder / "a.csv", "--out", out});
            CAPTURE(outcome.err);
            REQUIRE(outcome.code == 0);
            CHECK(read_sensor_info(out / "rock_01.txt").sampling_rate == about(rate));
        }
    }

    TEST_CASE("files without what is needed are refused in one line with their columns and what to "
              "add") {
        const TemporaryDirectory folder;
        struct Foreign {
            std::string name, text;
            std::vector<const char*> said;
        };
        const std::vector<Foreign> all{
            {"machine.csv",
             "Time [s];Load [kN];Displacement [mm];Volume change [ml]\n"
             "0,000;0,110;0,000;0,000\n12,000;1,105;0,030;0,380\n",
             {"expected columns of accelerations", "found the columns \"Time [s]\", \"Load [kN]\"",
              "add --axes"}},
            {"xyz.csv",
             "ax,ay,az\n0.007313,0.301245,9.797366\n0.107054,0.347431,9.952947\n",
             {"expected a column of times or a sampling rate",
              "among the columns \"ax\", \"ay\", \"az\"", "add --rate HZ"}},
            {"still.csv",
             "t [s],id,ax,ay,az\n5,1,0,0,9.81\n5,1,0,0,9.81\n",
             {"sensor 1: expected times that advance by more than 1e-06 s, found intervals of 0 "
              "s"}},
            {"back.csv",
             "t [s],id,ax,ay,az\n5,1,0,0,9.81\n4,1,0,0,9.81\n",
             {"found intervals of -1 s"}}};
        for (const Foreign& file : all) {
            CAPTURE(file.name);
            write_whole(folder / file.name, file.text);
            const Outcome outcome =
                run_process({"recordings", "--new", folder / file.name, "--out", folder / "out"});
            CHECK(outcome.code == 2);
            CHECK(is_one_line_of(outcome.err, "recordings"));
            for (const char* text : file.said)
                CHECK_MESSAGE(has(outcome.err, text), text << "\n" << outcome.err);
            CHECK_FALSE(fs::exists(folder / "out/55kPa"));
            fs::remove_all(folder / "out");
        }
        const Outcome machine =
            run_process({"recordings", "--new", folder / "xyz.csv", "--new-machine",
                         folder / "machine.csv", "--out", folder / "out"});
        CHECK(has(machine.err, "looks like axial_strain, deviatoric_stress_Pa, found none among "
                               "\"Time [s]\", \"Load [kN]\""));
    }

    TEST_CASE("files of a logger become a track's folder of passages, which is judged without a "
              "test machine, or a test if its pressure is given") {
        const TemporaryDirectory folder;
        const auto text = [](int shift) {
            std::string rows = "x y z\n";
            for (int k = 0; k < 300; ++k)
                rows += fmt::format("{:.4f} 0.3 {:.4f}\n", 1e-3 * std::sin(0.3 * k + shift),
                                    9.8 + 1e-3 * std::sin(0.7 * k + shift));
            return rows;
        };
        const fs::path first = folder / "sensor_1.csv", second = folder / "sensor_2.csv";
        write_whole(first, text(0));
        write_whole(second, text(1));
        const Outcome made = run_process(
            {"recordings", "--new", first, second, "--rate", "200", "--out", folder / "track"});
        CAPTURE(made.err);
        REQUIRE(made.code == 0);
        CHECK(has(made.out, "sensor_2.csv: The file is of one sensor, 2, by its name."));
        CHECK(read_sensor_info(folder / "track/rock_02.txt").sampling_rate == about(200));
        const auto infos = read_sensor_infos(folder / "track");
        const auto back = read_recordings(folder / "track/sensor_2/recordings.csv", infos);
        CHECK(back[1].size() == 300);
        CHECK(back[1].time.back() == about(299 / 200.0));
        const Outcome judged =
            run_process({"recordings", folder / "track", "--out", folder / "judged"});
        CAPTURE(judged.err);
        REQUIRE(judged.code == 0);
        fs::create_directories(folder / "raw");
        for (const fs::path& file : {first, second}) fs::copy(file, folder / "raw");
        const Outcome by_folder = run_process(
            {"recordings", "--new", folder / "raw", "--rate", "200", "--out", folder / "all"});
        CAPTURE(by_folder.err);
        CHECK(by_folder.code == 0);
        CHECK(read_whole(folder / "all/sensor_2/recordings.csv") ==
              read_whole(folder / "track/sensor_2/recordings.csv"));
        CHECK(has(judged.out, "Sensor 1: accepted in 1 of 1 passages."));
        CHECK(
            has(read_whole(folder / "judged/quality_control.txt"), "sensor_2\nsensor 2: accepted"));
        const Outcome again =
            run_process({"recordings", "--new", first, "--rate", "200", "--out", folder / "track"});
        CHECK(again.code == 2);
        CHECK(has(again.err, "expected a folder without recordings"));
        const Outcome test = run_process({"recordings", "--new", first, second, "--rate", "200",
                                          "--axes", "ax=3, ay=1, az=2", "--confining-pressure",
                                          "110e3", "--out", folder / "test"});
        CAPTURE(test.err);
        REQUIRE(test.code == 0);
        const auto of_test = read_recordings(folder / "test/110kPa/recordings.csv",
                                             read_sensor_infos(folder / "test"));
        REQUIRE(of_test.size() == 2);
        CHECK(of_test[1].force[0].x() == doctest::Approx(9.8).epsilon(1e-3));
    }

    TEST_CASE("a unit that is not known is asked: the guessed map is kept, and read when it is "
              "completed") {
        const TemporaryDirectory folder;
        const auto csv = folder / "a.csv", out = folder / "out", map = folder / "out/columns.txt";
        write_whole(csv, "t [s],id,ax [g],ay [g],az [g],gx [Grad/s],gy [Grad/s],gz [Grad/s]\n"
                         "0,1,0,0,1,90,0,0\n1,1,0,0,1,90,0,0\n2,1,0,0,1,90,0,0\n");
        const auto make = [&] { return run_process({"recordings", "--new", csv, "--out", out}); };
        const Outcome asked = make();
        CHECK(asked.code == 2);
        CHECK(is_one_line_of(asked.err, "recordings"));
        CHECK(has(asked.err, "gx (\"gx [Grad/s]\"): the unit \"Grad/s\" is not known"));
        CHECK(has(asked.err, "give them in " + map.string()));
        CHECK_FALSE(fs::exists(out / "55kPa"));
        std::string text = read_whole(map);
        CHECK(has(text, "gx = \"gx [Grad/s]\", ?\n#   one of rad/s, mrad/s, deg/s"));
        const Outcome again = make(); // as it is: the line of the map
        CHECK(again.code == 2);
        CHECK(has(again.err, "columns.txt:11: expected a unit of gx"));
        std::string completed;
        for (const char c : text) completed += c == '?' ? std::string("deg/s") : std::string(1, c);
        write_whole(map, completed);
        const Outcome made = make();
        CAPTURE(made.err);
        REQUIRE(made.code == 0);
        const auto infos = read_sensor_infos(out);
        const auto recordings = read_recordings(out / "55kPa/recordings.csv", infos,
                                                read_column_map(map, recording_columns()));
        CHECK(recordings[0].rate[1].x() == about(pi / 2));
        CHECK(recordings[0].force[1].z() == about(standard_gravity));
    }

    TEST_CASE("contradictions between units and what else is known are said") {
        const TemporaryDirectory folder;
        write_whole(folder / "a.csv", "# rate 100 Hz\nt [s],id,ax [m/s2],ay [m/s2],az [m/s2]\n"
                                      "0,1,0,0,1\n1,1,0,0,1\n2,1,0,0,1\n");
        const Outcome outcome =
            run_process({"recordings", "--new", folder / "a.csv", "--out", folder / "out"});
        CHECK(outcome.code == 0); // what is stated holds
        CHECK(read_sensor_info(folder / "out/rock_01.txt").sampling_rate == about(1));
        CHECK(has(outcome.out, "sensor 1: the acceleration at the beginning is 1 m/s2"));
        CHECK(has(outcome.out, "sensor 1: 1 samples a second by the times, 100 by the file"));
    }

    TEST_CASE("a column of text that nobody asked for is ignored, and named once in the report") {
        const TemporaryDirectory folder;
        const fs::path own = folder / "own";
        fs::create_directories(own);
        for (int k = 1; k <= 10; ++k)
            fs::copy(assets_folder() / fmt::format("smartrock/rock_{:02}.txt", k), own);
        std::string text;
        std::istringstream in(read_whole(assets_folder() / "smartrock/55kPa/recordings.csv"));
        for (std::string line; std::getline(in, line);)
            text += line +
                    (line.starts_with('#')   ? ""
                     : line.starts_with('t') ? ",clock"
                                             : ",12:00:00") +
                    "\n";
        write_whole(own / "55kPa/recordings.csv", text);
        fs::copy(assets_folder() / "smartrock/55kPa/test.csv", own / "55kPa");
        const Outcome outcome =
            run_process({"recordings", own, "--out", folder / "out", "--quiet"});
        CAPTURE(outcome.err);
        CHECK(outcome.code == 0);
        CHECK(has(outcome.out, "55kPa: all 10 sensors are accepted; the test machine is accepted"));
        CHECK(has(read_whole(folder / "out/quality_control.txt"),
                  "sensors 1 to 10: fields: 1 of the file is not used: clock\n"));
    }

    TEST_CASE("texts of variable length in HDF5, as h5py writes them, are read as those of fixed "
              "length, and units of datasets must be those of the metadata") {
        using testing::ForeignText;
        const TemporaryDirectory folder;
        const fs::path own = folder / "in", path = own / "55kPa/recordings.h5";
        std::vector<double> time, strain, force, accel, confining(20, 55e3);
        for (int k = 0; k < 20; ++k) {
            time.push_back(12 * k);
            strain.push_back(1e-3 * k);
            force.push_back(1e3 + k);
            for (const double a : {5.32, 4.90, 6.64}) accel.push_back(a);
        }
        Hdf5File file = Hdf5File::create(path);
        file.write<double>("/sensors/1/time", time);
        file.write<double>("/sensors/1/strain", strain);
        file.write<double>("/sensors/1/accel", accel, {20, 3});
        file.write<double>("/sensors/1/humidity", time);
        file.set_attribute<std::int64_t>("/sensors/1", "id", 1);
        for (const auto& [name, numbers] : {std::pair{"time", &time},
                                            {"strain", &strain},
                                            {"force", &force},
                                            {"confining", &confining}})
            file.write<double>(std::string("/bench/") + name, *numbers);
        file.set_attribute<double>("/bench", "area", 0.018);
        file.close();
        testing::set_foreign_text(path, "/sensors/1", "force_unit", "m/s2", ForeignText::variable);
        testing::set_foreign_text(path, "/sensors/1", "sampling_rate", "0.08333333",
                                  ForeignText::variable);
        testing::set_foreign_text(path, "/sensors/1", "firmware", "1.2.3", ForeignText::variable);
        testing::set_foreign_text(path, "/sensors/1/time", "units", "seconds",
                                  ForeignText::variable);
        const auto infos = read_sensor_infos(own);
        CHECK(infos[0].force_unit == "m/s2");
        CHECK(infos[0].sampling_rate == about(0.08333333));
        const RecordedTest test = read_recorded_test(own, 55e3, infos, {});
        CHECK(test.recordings[0].force[3].y() == 4.90);
        CHECK(test.recordings[0].unused == std::vector<std::string>{"humidity", "@firmware"});
        const Outcome outcome = run_process({"recordings", own, "--out", folder / "out"});
        CHECK_MESSAGE(outcome.code == 0, outcome.err);
        // in another unit than that in which it is read
        testing::set_foreign_text(path, "/sensors/1/accel", "units", "g", ForeignText::variable);
        CHECK(has(message_of<InputError>([&] { (void)read_recorded_test(own, 55e3, infos, {}); }),
                  "/sensors/1/accel: units: expected m/s2, in which it is read, found g"));
        testing::set_foreign_text(path, "/bench/force", "unit", "kN", ForeignText::padded);
        CHECK(has(message_of<InputError>([&] { (void)read_machine_record(path, 55e3); }),
                  "/bench/force: unit: expected N, in which it is read, found kN"));
    }

    TEST_CASE("recordings and smart_triaxial refuse the same positions with the same words") {
        const TemporaryDirectory folder;
        const fs::path own = folder / "own";
        fs::copy(assets_folder() / "smartrock", own, fs::copy_options::recursive);
        SensorInfo third = read_sensor_info(own / "rock_03.txt");
        third.placed_x = 1.5; // outside, over the radius
        write_sensor_info(own / "rock_03.txt", third);
        const Outcome judged = run_process({"recordings", own, "--confining-pressure", "55e3",
                                            "--out", folder / "judged", "--quiet"}),
                      refused = run_process({"smart_triaxial", "--recordings", own, "--out",
                                             folder / "refused", "--quiet"});
        CHECK(judged.code == 0);
        CHECK(has(judged.out, "55kPa: 9 of 10 sensors are accepted, refused: sensor 3"));
        const std::string report = read_whole(folder / "judged/quality_control.txt"),
                          start = "sensor 3: refused: position: ";
        const auto at = report.find(start);
        REQUIRE(at != std::string::npos);
        const std::string reason =
            report.substr(at + start.size(), report.find('\n', at) - at - start.size());
        CHECK(has(reason, "expected a sensor rock inside the mould"));
        CHECK(refused.code == 2);
        CHECK(has(refused.err, reason));
    }
}

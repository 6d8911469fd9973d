// Files of loggers as makers publish their form, and every other form that a table of samples may
// have: what is stated holds, what is not stated is taken only where one reading is possible, and
// everything else is refused in one line.

#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/records/logger_file.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/records/logged.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>

using namespace bris;
using testing::Logged;
using testing::logged_text;

namespace {

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// Without waiting for the disk.
void write(const std::filesystem::path& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}

LoggerFile read(const std::string& text, const LoggerSettings& settings = {},
                const char* name = "a.csv") {
    const TemporaryDirectory folder;
    const auto path =
        folder / "files" / name; // a folder's name may state a number, a random one too
    std::filesystem::create_directories(path.parent_path());
    write(path, text);
    return read_logger_file(path, settings);
}

std::string refusal_of(const std::string& text, const LoggerSettings& settings = {}) {
    const std::string message = message_of<InputError>([&] { (void)read(text, settings); });
    CHECK(message.find('\n') == std::string::npos);
    CHECK(has(message, "a.csv"));
    return message;
}

bool is_noted(const LoggerFile& file, const std::string& part) {
    return std::ranges::any_of(file.notes,
                               [&](const std::string& note) { return has(note, part); });
}

/// Lines of a text made from the number of the line.
std::string lines(int count, auto&& line) {
    std::string text;
    for (int k = 0; k < count; ++k) text += line(k) + "\n";
    return text;
}

/// Changes bytes, numbers and lines of a file at random, a few or many of them.
void damage(std::string& text, Random& random) {
    const auto below = [&](std::size_t n) {
        return std::min(n - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(n)));
    };
    constexpr std::array<const char*, 10> words{"nan", "1e999", "-",    "\"",    ",,",
                                                "0",   "1e308", "\n\n", "25:61", "9999-99-99"};
    const std::size_t changes = 1 + below(8);
    for (std::size_t k = 0; k < changes && !text.empty(); ++k) {
        const std::size_t at = below(text.size()), begin = text.rfind('\n', at) + 1,
                          end = std::min(text.find('\n', at), text.size() - 1) + 1;
        switch (below(6)) {
        case 0:
            text[at] = static_cast<char>(below(256));
            break;
        case 1:
            text.insert(at, words[below(words.size())]);
            break;
        case 2:
            text.erase(at, below(20));
            break;
        case 3: // a line is removed
            if (begin < end) text.erase(begin, end - begin);
            break;
        case 4: // a line is repeated, perhaps elsewhere
            if (begin < end) text.insert(below(2) ? begin : 0, text.substr(begin, end - begin));
            break;
        default:
            text.resize(below(2) ? at : text.size());
        }
    }
}

/// Vertical vibration, m/s2.
double shake(int k) { return 0.3 * std::sin(0.7 * k); }

} // namespace

TEST_SUITE("records/logger_file") {
    TEST_CASE("a file of phyphox has its units in the titles, and its absolute value is ignored") {
        const auto file = read("\"Time (s)\",\"Acceleration x (m/s^2)\",\"Acceleration y (m/s^2)\","
                               "\"Acceleration z (m/s^2)\",\"Absolute acceleration (m/s^2)\"\n" +
                               lines(40, [](int k) {
                                   return fmt::format("{:.9E},-5.9E-02,2.4E-01,{:.9E},9.8E+00",
                                                      0.005 * k, 9.8 + shake(k));
                               }));
        REQUIRE(file.recordings.size() == 1);
        const Recording& r = file.recordings[0];
        CHECK(r.size() == 40);
        CHECK(r.info.sampling_rate == about(200));
        CHECK(r.force[3].x() == about(-0.059));
        CHECK(r.force[3].z() == about(9.8 + shake(3)));
        CHECK(r.rate.empty());
        CHECK(file.has_gravity);
        CHECK_FALSE(file.is_absolute);
        CHECK_FALSE(file.has_id);
        CHECK(is_noted(file, "Not used: \"Absolute acceleration (m/s^2)\" (column 5)"));
    }

    TEST_CASE(
        "linear acceleration is read without gravity, which is added along z so that there is "
        "a vertical; one with gravity beside it is preferred") {
        const std::string linear = "\"Linear Acceleration x (m/s^2)\";"
                                   "\"Linear Acceleration y (m/s^2)\";"
                                   "\"Linear Acceleration z (m/s^2)\"";
        const auto row = [](int k) {
            return fmt::format("{};0,1;0,2;{}", testing::with_comma(0.005 * k),
                               testing::with_comma(shake(k)));
        };
        const auto file = read("\"Time (s)\";" + linear + "\n" + lines(40, row));
        CHECK_FALSE(file.has_gravity);
        CHECK(file.recordings[0].force[5].y() == about(0.2));
        CHECK(file.recordings[0].force[5].z() == about(standard_gravity + shake(5)));
        CHECK(is_noted(file, "without gravity; z is taken as vertical"));
        const auto both = read("\"Time (s)\";" + linear +
                               ";\"Acceleration x (m/s^2)\";\"Acceleration y (m/s^2)\";"
                               "\"Acceleration z (m/s^2)\"\n" +
                               lines(40, [&](int k) { return row(k) + ";0,5;0,6;9,8"; }));
        CHECK(both.has_gravity);
        CHECK(both.recordings[0].force[5].z() == about(9.8));
    }

    TEST_CASE("a file of Sensor Logger has times in nanoseconds, and axes in the order z, y, x") {
        const std::string text =
            "time,seconds_elapsed,z,y,x\n" + lines(40, [](int k) {
                return fmt::format("{},{:.9f},{},0.3,-0.05", 1718600000000000000LL + 5000000LL * k,
                                   0.005 * k, 9.8 + shake(k));
            });
        const auto file = read(text);
        CHECK(file.is_absolute);
        CHECK(file.recordings[0].time[0] == about(1718600000));
        CHECK(file.recordings[0].info.sampling_rate == about(200).epsilon(1e-4));
        CHECK(file.recordings[0].force[2].isApprox(Vec3(-0.05, 0.3, 9.8 + shake(2))));
        CHECK(is_noted(file, "as Sensor Logger writes it"));
        const auto rates = read(text, {}, "Gyroscope.csv"); // the same columns
        CHECK(rates.recordings[0].force.empty());
        CHECK(rates.recordings[0].rate[2].y() == about(0.3));
    }

    TEST_CASE("a file of Xsens has a rate in its header, a counter, and empty columns") {
        const std::string text =
            "// General information: \n//  Coordinate system: ENU\n//  Update Rate: 100.0Hz\n"
            "PacketCounter\tSampleTimeFine\tYear\tAcc_X\tAcc_Y\tAcc_Z\tGyr_X\tGyr_Y\tGyr_"
            "Z\tRoll\n" +
            lines(40, [](int k) {
                return fmt::format("{}\t\t\t0.03\t0.28\t{}\t0.034\t-0.014\t{}\t0.1",
                                   (65520 + k + (k > 30 ? 2 : 0)) % 65536, 9.8 + shake(k),
                                   shake(k));
            });
        const auto file = read(text, {}, "xsens.txt");
        const Recording& r = file.recordings[0];
        CHECK(r.info.sampling_rate == about(100));
        CHECK(r.time[30] == about(0.30)); // over the end of the counter
        CHECK(r.time[31] == about(0.33)); // two samples are missing
        CHECK(r.sequence[31] - r.sequence[30] == 3);
        CHECK(r.rate[4].z() == about(shake(4)));
        CHECK(is_noted(file, "2 samples are missing by the counter"));
        CHECK(is_noted(file, "\"Roll\" (column 10)"));
    }

    TEST_CASE(
        "a rate in a comment and a counter of lines give the times; units are in the titles") {
        const std::string text =
            "# Logger data\n# Num. samples: 600, Duration: 0.3 s\n"
            "# Config: data_rate = 2000.0 Hz, acc_range = 4 g\n"
            "csvline, accX_g, accY_g, accZ_g, gyrX_dps, gyrY_dps, gyrZ_dps\n" +
            lines(40, [](int k) {
                return fmt::format("{},-0.001,0.029,{},90,-1.5,-0.9", k, 1 + 0.1 * shake(k));
            });
        const auto file = read(text);
        CHECK(file.recordings[0].info.sampling_rate == about(2000));
        CHECK(file.recordings[0].time[39] == about(39 / 2000.0));
        CHECK(file.recordings[0].force[0].y() == about(0.029 * standard_gravity));
        CHECK(file.recordings[0].rate[0].x() == about(pi / 2));
        // the user's rate holds
        CHECK(read(text, {.rate = 1000, .axes = "", .columns = {}})
                  .recordings[0]
                  .info.sampling_rate == about(1000));
    }

    TEST_CASE("sensors by names, with and without a line of names, are those of the numbers in the "
              "names, each with its own rate") {
        for (const std::string header : {"", " Time ,Sensor,X-Axis,Y-Axis,Z-Axis\n"}) {
            const auto file =
                read(header + lines(60, [](int k) {
                         return fmt::format("{}.00,S{}:,0.01,0.03,{}", 1643200000000LL + 4 * k,
                                            3 - k % 3, 1 + 0.1 * shake(k));
                     }));
            REQUIRE(file.recordings.size() == 3);
            CHECK(file.is_absolute);
            CHECK(file.has_id);
            for (unsigned s = 0; s < 3; ++s) {
                CHECK(file.recordings[s].info.id == s + 1);
                CHECK(file.recordings[s].size() == 20);
                CHECK(file.recordings[s].info.sampling_rate == about(1000.0 / 12).epsilon(1e-4));
            }
            CHECK(file.recordings[2].force[0].z() == about(standard_gravity));
            CHECK(is_noted(file, "3 is \"S3:\", 2 is \"S2:\", 1 is \"S1:\""));
        }
        const auto named =
            read("t [s],node,ax [g],ay [g],az [g]\n" + lines(40, [](int k) {
                     return fmt::format("{},{},0,0,1", 0.01 * k, k % 2 == 0 ? "north" : "south");
                 }));
        CHECK(named.recordings[1].info.id == 2);
        CHECK(is_noted(named, "1 is \"north\", 2 is \"south\""));
    }

    TEST_CASE("one axis with date and time, without gravity, is taken as the vertical") {
        const auto file =
            read("Time (-),ACC01_z [g],FRC-01 [kN],INC01 [deg]\n" + lines(300, [](int k) {
                     return fmt::format("2022-11-04 08:36:{:02}.{:02}7,{},230.35,0.008",
                                        24 + k / 100, k % 100, 1e-4 * shake(k));
                 }));
        const Recording& r = file.recordings[0];
        CHECK(file.is_absolute);
        CHECK(r.time[0] == about(1667550984.007));
        CHECK(r.info.sampling_rate == about(100).epsilon(1e-4));
        CHECK_FALSE(file.has_gravity);
        CHECK(r.force[7].x() == 0);
        CHECK(r.force[7].z() == about(standard_gravity * (1 + 1e-4 * shake(7))));
        const auto lying = read("t [s],ax [g]\n" + lines(40, [](int k) {
                                    return fmt::format("{},{}", 0.01 * k, 1e-3 * shake(k));
                                }));
        CHECK(lying.recordings[0].force[0].x() == about(standard_gravity));
        CHECK(is_noted(lying, "x is taken as vertical"));
    }

    TEST_CASE("a file without times is refused in a line that says what to add, and read with it") {
        for (const char* header : {"x y z", "ax,ay,az"}) {
            const char sign = header[1];
            const std::string text =
                std::string(header) + "\n" + lines(40, [&](int k) {
                    return fmt::format("0.1{}0.2{}{}", sign == ' ' ? ' ' : ',',
                                       sign == ' ' ? ' ' : ',', 9.8 + shake(k));
                });
            const std::string said = refusal_of(text);
            CHECK(has(said, "expected a column of times or a sampling rate, found neither among "
                            "the columns \""));
            CHECK(has(said, "add --rate HZ"));
            const auto file = read(text, {.rate = 250, .axes = "", .columns = {}});
            CHECK(file.recordings[0].info.sampling_rate == about(250));
            CHECK(file.recordings[0].time[39] == about(39 / 250.0));
            CHECK(file.recordings[0].force[6].z() == about(9.8 + shake(6)));
        }
    }

    TEST_CASE("what was measured comes back the same in every unit, with every delimiter, decimal "
              "sign and form of the time") {
        std::size_t tried = 0;
        for (const char delimiter : {',', ';', '\t', ' '})
            for (const char decimal : {'.', ','})
                for (const char* time :
                     {"s", "ms", "us", "ns", "epoch s", "epoch ms", "epoch us", "epoch ns", "date",
                      "date T", "date Z", "day and time", "count", "none"})
                    for (const char* force : {"m/s2", "g", "mg", "?"})
                        for (const char* rate : {"rad/s", "deg/s", ""})
                            for (const bool has_names : {true, false}) {
                                const Logged form{delimiter, decimal, time, force, rate, has_names};
                                if (!form.is_possible()) continue;
                                CAPTURE(logged_text(form, 3));
                                const auto file =
                                    read(logged_text(form, 24),
                                         {.rate = form.needs_rate() ? testing::logged_rate : 0,
                                          .axes = form.axes(),
                                          .columns = {}});
                                REQUIRE(file.recordings.size() == 1);
                                CHECK(testing::difference_from_logged(file.recordings[0], form) ==
                                      "");
                                CHECK(file.is_absolute == form.has_dates());
                                ++tried;
                            }
        CHECK(tried > 800);
    }

    TEST_CASE("a unit or a rate that is stated is not replaced by a guess") {
        // gravity is there in another unit
        CHECK(
            has(refusal_of("t [s],ax [m/s2],ay [m/s2],az [m/s2]\n" +
                           lines(20, [](int k) { return fmt::format("{},0,0,1", 0.01 * k); })),
                "found a median of 1 m/s2, which is gravity in g; give the right unit with --axes "
                "\"ax=2 g\""));
        // the user's unit holds against that of the file
        const std::string text = "t [ms],ax [m/s2],ay [m/s2],az [m/s2]\n" +
                                 lines(20, [](int k) { return fmt::format("{},0,0,1", 10 * k); });
        const auto file = read(text, {.rate = 0, .axes = "ax=2 g, ay=3, az=-4", .columns = {}});
        CHECK(file.recordings[0].force[0].z() == about(-standard_gravity));
        CHECK(file.recordings[0].info.sampling_rate == about(100));
        // rates
        CHECK(has(refusal_of(text, {.rate = 90, .axes = "ax=2 g", .columns = {}}),
                  "expected 90 samples a second (--rate), found 100 by the times"));
        CHECK(read(text, {.rate = 99, .axes = "az=4 g", .columns = {}})
                  .recordings[0]
                  .info.sampling_rate == about(99));
        CHECK(is_noted(read("# rate 50 Hz\n" + text, {.rate = 0, .axes = "az=4 g", .columns = {}}),
                       "100 samples a second by the times, which are used; the file states 50 Hz"));
        // 5 s or 200 Hz
        const std::string open = "time,ax [g],ay [g],az [g]\n" +
                                 lines(20, [](int k) { return fmt::format("{},0,0,1", 5 * k); });
        CHECK(has(refusal_of(open), "several that are possible; add --rate HZ, or the unit such as "
                                    "--axes \"t=1 ms\""));
        CHECK(read(open, {.rate = 200, .axes = "", .columns = {}}).recordings[0].time[1] ==
              about(0.005));
        CHECK(read(open, {.rate = 0, .axes = "t=1 s", .columns = {}}).recordings[0].time[1] ==
              about(5));
    }

    TEST_CASE("what cannot be told is refused with the columns and what to add") {
        const auto table = [](const std::string& names, const std::string& row) {
            return names + "\n" +
                   lines(20, [&](int k) { return fmt::format("{},", 0.01 * k) + row; });
        };
        CHECK(has(refusal_of("no table\nat all\n"),
                  "expected lines of numbers separated by commas, semicolons, tabs or blanks"));
        CHECK(has(refusal_of(table("t [s],Load [kN],Weg [mm]", "1,2")),
                  "found the columns \"t [s]\", \"Load [kN]\", \"Weg [mm]\"; add --axes"));
        CHECK(has(
            refusal_of(table("t [s],ax [foo],ay [foo],az [foo]", "0,0,1")),
            "the unit \"foo\" is not known; give one of m/s2, g, mg with --axes \"ax=2 m/s2\""));
        CHECK(has(refusal_of(table("t [s],ax,ay,az", "0,0,0.2")),
                  "median of 0.2 is gravity in none; give it with --axes \"ax=2 m/s2\""));
        CHECK(has(refusal_of(table("t [s],ax [g],ay [g],az [mg]", "0,0,1")),
                  "expected one unit for all axes, found g and mg"));
        CHECK(
            has(refusal_of(lines(20, [](int k) { return fmt::format("{},1.5,2,3,4", 0.01 * k); })),
                "of which 4 are left; add --axes"));
        const std::string good = table("t [s],ax [g],ay [g],az [g]", "0,0,1");
        for (const auto& [axes, said] :
             {std::pair{"ax=9", "expected the number or title of a column"},
              {"bx=2", "expected entries such as \"ax=2\""},
              {"ax=2, ay=2", "expected each name and each column once"},
              {"ax=2 foo", "expected a unit, one of m/s2, g, mg, found \"foo\""}})
            CHECK(has(message_of<InputError>([&, axes = axes] {
                          (void)read(good, {.rate = 0, .axes = axes, .columns = {}});
                      }),
                      said));
        const auto rates = read(table("t [s],ax [g],ay [g],az [g],gx,gy,gz", "0,0,1,1,2,3"));
        CHECK(rates.recordings[0].rate.empty()); // rad/s and deg/s look the same
        CHECK(is_noted(rates, "whose unit is not stated; give it with --axes \"gx=5 deg/s\""));
    }

    TEST_CASE("damaged rows, and times that repeat or go back, are counted; too many are refused") {
        const auto text = [](int every, const std::string& damage) {
            return "t [s],ax [g],ay [g],az [g]\n" + lines(200, [&](int k) {
                       return k % every == every / 2 ? damage : fmt::format("{},0,0,1", 0.01 * k);
                   });
        };
        const auto file = read(text(50, "0.1,0,x,1"));
        CHECK(file.recordings[0].size() == 196);
        CHECK(is_noted(file, "Left out: 4 of 200 rows that cannot be read, the first in line 27: "
                             "expected a number in \"ay [g]\" (column 3), found \"x\""));
        CHECK(has(refusal_of(text(10, "0.1,0")),
                  "a.csv:7: expected 4 columns, found 2, as in 20 of 200 rows"));
        CHECK(is_noted(read(text(100, "0,0,0,1")), "left out: 2 of 200 rows whose times go back"));
        CHECK(has(refusal_of(text(2, "0,0,0,1")), "cut the file where its clock begins again"));
        const auto coarse = read("t [s],ax [g],ay [g],az [g]\n" + lines(200, [](int k) {
                                     return fmt::format("{},0,0,{}", 0.1 * (k / 10), 1 + 1e-3 * k);
                                 }));
        CHECK(coarse.recordings[0].size() == 200); // packets of ten samples
        CHECK(coarse.recordings[0].info.sampling_rate == about(100).epsilon(1e-6));
        CHECK(coarse.recordings[0].time[13] == about(0.13));
        const auto milliseconds = read("t [ms],ax [g],ay [g],az [g]\n" + lines(300, [](int k) {
                                           return fmt::format("{},0,0,1", k * 10 / 3);
                                       }));
        CHECK(milliseconds.recordings[0].info.sampling_rate == about(300).epsilon(5e-3));
    }

    TEST_CASE(
        "the number of a sensor is in the name of the file or its folder, or of the columns") {
        const std::string text = "t [s],ax [g],ay [g],az [g]\n" +
                                 lines(20, [](int k) { return fmt::format("{},0,0,1", 0.01 * k); });
        for (const auto& [name, id] : {std::pair{"run_s2.csv", 2u},
                                       {"Sensor-07.csv", 7u},
                                       {"sensor 3/data.csv", 3u},
                                       {"rock_04/passage_11.csv", 4u},
                                       {"phyphox 2024.csv", 1u}}) {
            CAPTURE(name);
            CHECK(read(text, {}, name).recordings[0].info.id == id);
        }
        const auto two = read("t [s],ACC01_z [g],ACC02_z [g]\n" + lines(20, [](int k) {
                                  return fmt::format("{},{},1", 0.01 * k, 1e-3 * shake(k));
                              }));
        REQUIRE(two.recordings.size() == 2);
        CHECK(two.recordings[1].info.id == 2);
        CHECK(two.recordings[1].force[0].z() == about(standard_gravity));
    }

    TEST_CASE("files of other makes are read by their titles: prefixes, lines of units, comments "
              "and several clocks") {
        const auto z = [](int k) { return 1 + 0.1 * shake(k); };
        struct Make {
            std::string head;
            std::function<std::string(int)> row;
            double rate;
            bool is_absolute;
        };
        const std::vector<Make> makes{
            {"sep=\\t\nShimmer_AB_Timestamp_Unix_CAL\tShimmer_AB_Accel_LN_X_CAL\t"
             "Shimmer_AB_Accel_LN_Y_CAL\tShimmer_AB_Accel_LN_Z_CAL\nms\tm/(s^2)\tm/(s^2)\t"
             "m/(s^2)\n",
             [&](int k) {
                 return fmt::format("{}\t0.5\t0\t{}\t", 1715076000000 + 7.8125 * k, 9.8 * z(k));
             },
             128, true},
            {"epoch (ms),time (02:00),elapsed (s),x-axis (g),y-axis (g),z-axis (g)\n",
             [&](int k) {
                 return fmt::format("{},x,{},0.05,0,{}", 1715076000000 + 10 * k, 0.01 * k, z(k));
             },
             100, true},
            {"time,gFx,gFy,gFz,TgF\n",
             [&](int k) { return fmt::format("{},0.05,0,{},1", 0.01 * k, z(k)); }, 100, false},
            {"loggingTime(txt),accelerometerAccelerationX(G),accelerometerAccelerationY(G),"
             "accelerometerAccelerationZ(G),motionUserAccelerationX(G)\n",
             [&](int k) {
                 return fmt::format("2024-05-07T12:00:00.{:03}+02:00,0.05,0,{},0.7", 10 * k, z(k));
             },
             100, true},
            {"% time ax ay az\n% s g g g\n",
             [&](int k) { return fmt::format("  {}  5.0e-02 0  {}", 0.001 * k, z(k)); }, 1000,
             false},
            {"Datum;Beschleunigung X [g];Beschleunigung Y [g];Beschleunigung Z [g]\n",
             [&](int k) {
                 return fmt::format("07.05.2024 10:00:00,{:03};0,05;0;{}", 5 * k,
                                    testing::with_comma(z(k)));
             },
             200, true}};
        for (const Make& make : makes) {
            CAPTURE(make.head);
            const auto file = read(make.head + lines(60, make.row));
            REQUIRE(file.recordings.size() == 1);
            const Recording& r = file.recordings[0];
            CHECK(r.info.sampling_rate == about(make.rate).epsilon(1e-4));
            CHECK(file.is_absolute == make.is_absolute);
            CHECK(std::abs(r.force[9].x() - 0.5) < 0.02);
            CHECK(std::abs(r.force[9].z() - 9.8 * z(9)) < 0.02);
            if (file.is_absolute) CHECK(std::abs(r.time[0] - 1715076000) < 1e-3);
        }
        const auto rates =
            read("t [s],x-axis (deg/s),y-axis (deg/s),z-axis (deg/s)\n" +
                 lines(20, [](int k) { return fmt::format("{},90,0,0", 0.01 * k); }));
        CHECK(rates.recordings[0].rate[0].x() == about(pi / 2));
    }

    TEST_CASE("damaged files of every form are read or refused, and what is read has as many "
              "samples in each channel") {
        std::vector<std::string> texts;
        for (const auto& form : {Logged{',', '.', "date", "g", "deg/s", true},
                                 {';', ',', "ms", "?", "", true},
                                 {'\t', '.', "count", "mg", "rad/s", true},
                                 {' ', '.', "none", "?", "", false},
                                 {',', '.', "epoch ms", "?", "", false},
                                 {';', '.', "day and time", "g", "", true}})
            texts.push_back(logged_text(form, 30));
        texts.push_back("# rate 100 Hz\n" + lines(30, [](int k) {
                            return fmt::format("{},S{}:,0,0.1,1.01", 1643200000000LL + 5 * k,
                                               k % 3);
                        }));
        const TemporaryDirectory folder;
        std::size_t taken = 0, refused = 0;
        for (std::uint64_t number = 0; number < 4000; ++number) {
            Random random(23, number);
            std::string text = texts[number % texts.size()];
            damage(text, random);
            write(folder / "a.csv", text);
            try {
                const auto file = read_logger_file(
                    folder / "a.csv", {.rate = number % 2 ? 200.0 : 0, .axes = "", .columns = {}});
                REQUIRE_FALSE(file.recordings.empty());
                for (const Recording& r : file.recordings) {
                    REQUIRE(r.size() > 1);
                    REQUIRE((r.force.empty() || r.force.size() == r.size()));
                    REQUIRE((r.rate.empty() || r.rate.size() == r.size()));
                    REQUIRE((r.sequence.empty() || r.sequence.size() == r.size()));
                    REQUIRE(r.info.sampling_rate > 0);
                    REQUIRE(std::ranges::is_sorted(r.time));
                    for (const Vec3& f : r.force) REQUIRE(f.allFinite());
                }
                ++taken;
            } catch (const InputError&) {
                ++refused;
            }
        }
        CHECK(taken > 500);
        CHECK(refused > 500);
    }

    TEST_CASE("a column map describes a file that has no usual names") {
        const TemporaryDirectory folder;
        write(folder / "map.txt", "delimiter = semicolon\ndecimal = comma\nheader_line = 2\n"
                                  "t = \"A\", ms\nax = -\"B\", g\nay = \"C\", g\n"
                                  "az = \"D\", g\n");
        const auto file =
            read("made by hand\nA;B;C;D\n" +
                     lines(20, [](int k) { return fmt::format("{};0,5;0;1,0", 5 * k); }),
                 {.rate = 0, .axes = "", .columns = folder / "map.txt"});
        CHECK(file.recordings[0].force[0].x() == about(-0.5 * standard_gravity));
        CHECK(file.recordings[0].info.sampling_rate == about(200));
    }
}

// Column maps that are guessed from files of other makes: what a header states holds, what it does
// not state is taken only where one unit alone is possible, and everything else is asked.

#include "engine/errors.hpp"
#include "engine/io/column_map.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/records/guess_columns.hpp"
#include "scenarios/records/recorded_test.hpp"
#include "scenarios/sensors/unit_words.hpp"
#include "tests/engine/io/encoded.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>

using namespace bris;

namespace {

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

GuessedMap guess_of(const std::string& text, FileEvidence evidence = {}, bool of_machine = false) {
    const TemporaryDirectory folder;
    write_whole(folder / "a.csv", text);
    return guess_columns(folder / "a.csv", of_machine ? machine_columns() : recording_columns(),
                         evidence);
}

/// Rows of a rock at rest, every `interval`, below these names.
std::string at_rest(const std::string& names, double interval, double gravity = 9.81) {
    std::string text = names + "\n";
    for (int k = 0; k < 6; ++k) text += fmt::format("{},1,0.01,0.02,{}\n", interval * k, gravity);
    return text;
}

/// The unit of a column in a guessed map; "": none.
std::string unit_in(const GuessedMap& guess, const std::string& ours) {
    const auto at = guess.map.find("\n" + ours + " = ");
    REQUIRE(at != std::string::npos);
    const std::string line = guess.map.substr(at + 1, guess.map.find('\n', at + 1) - at - 1);
    const auto comma = line.rfind("\", ");
    return comma == std::string::npos ? "" : line.substr(comma + 3);
}

} // namespace

TEST_SUITE("records/guess_columns") {
    TEST_CASE("usual spellings of units are known, and no other word is taken for a unit") {
        const auto units_of = [](const char* name) -> const std::vector<ColumnUnit>& {
            return std::ranges::find(recording_columns(), name, &KnownColumn::name)->units;
        };
        const auto named = [&](const char* column, const char* word) {
            return unit_named(word, units_of(column));
        };
        for (const char* word :
             {"m/s2", "m/s^2", "m/s\u00b2", "m s-2", "m\u00b7s\u207b\u00b2", "m/s/s"})
            CHECK_MESSAGE(named("ax", word) == "m/s2", word);
        for (const char* word : {"deg/s", "dps", "DPS", "\u00b0/s", "\u00ba/s", "degrees/s"})
            CHECK_MESSAGE(named("gx", word) == "deg/s", word);
        for (const char* word : {"\u00b5s", "\u03bcs", "usec", "Microseconds"})
            CHECK_MESSAGE(named("t", word) == "us", word);
        CHECK(named("ax", "G") == "g");
        CHECK(named("mx", "G") == "G");
        CHECK(named("mx", "mG") == "mG");
        CHECK(named("temp", "\u00b0C") == "C");
        for (const char* word : {"", "x", "gal", "ft/s2", "m/s", "MG", "-"})
            CHECK_MESSAGE(named("ax", word) == "", word);
        CHECK(named("gx", "rps") == "");                            // radians or revolutions
        CHECK(unit_named("mPa", {{"Pa"}, {"kPa"}, {"MPa"}}) == ""); // millipascal
    }

    TEST_CASE("a unit that a header states is taken, whatever the size of the numbers") {
        for (const auto& [title, unit] : {std::pair{"Time (seconds)", "s"},
                                          {"Time (milliseconds)", "ms"},
                                          {"Time [ns]", "ns"},
                                          {"Timestamp_us", "us"},
                                          {"\"time, min\"", "min"},
                                          {"millis", "ms"},
                                          {"seconds_elapsed", "s"},
                                          {"timeMs", "ms"},
                                          {"Time/s", "s"}})
            for (const double interval : {1e-3, 0.5, 12.0, 12e3, 5e6}) {
                const auto guess =
                    guess_of(at_rest(std::string(title) + ",Node,ax,ay,az", interval));
                CAPTURE(title);
                CHECK(unit_in(guess, "t") == unit);
                CHECK(guess.open.empty());
            }
        CHECK(unit_in(guess_of(at_rest("t (s),id,accX_g,accY_g,accZ_g", 1, 9.81)), "az") == "g");
        CHECK(has(guess_of("t [s];id;ax [g];ay [g];az [g]\n0;1;0;0;1\n0,5;1;0;0;1\n").map,
                  "decimal = comma")); // not in the first line
        // in the line below the names
        const auto below = guess_of("t,id,ax,ay,az\n[ms],,mg,mg,mg\n0,1,0,0,9.81\n12,1,0,0,9.81\n");
        CHECK(unit_in(below, "t") == "ms");
        CHECK(unit_in(below, "ax") == "mg");
    }

    TEST_CASE(
        "a unit word that is not known, and a column whose unit nothing shows, are asked, and "
        "the map says so in a way that no reader takes") {
        const TemporaryDirectory folder;
        const auto guess = guess_of("t [s],id,ax,ay,az,Gyro X (foo),Gyro Y (foo),Gyro Z (foo),T\n"
                                    "0,1,0,0,9.81,1,2,3,21\n1,1,0,0,9.81,1,2,3,21\n");
        CHECK(guess.open.size() == 3);
        CHECK(has(guess.open.front(), "gx (\"Gyro X (foo)\"): the unit \"foo\" is not known"));
        CHECK(unit_in(guess, "gx") == "?");
        CHECK(unit_in(guess, "ax") == "m/s2"); // by gravity
        write_whole(folder / "columns.txt", guess.map);
        CHECK(has(message_of<InputError>(
                      [&] { (void)read_column_map(folder / "columns.txt", recording_columns()); }),
                  "expected a unit of gx, one of rad/s, mrad/s, deg/s, mdeg/s, rpm, found \"?\""));
        // rad/s and deg/s look the same
        const auto rates = guess_of("t [s],id,gx,gy,gz\n0,1,1,2,3\n1,1,1,2,3\n");
        CHECK(unit_in(rates, "gz") == "?");
        CHECK(has(rates.open.front(), "no unit is stated"));
        // "T [C]" is a temperature, or nothing, but no time
        CHECK(unit_in(guess_of("T [C],time [s],id,ax,ay,az\n20,0,1,0,0,1\n20,1,1,0,0,1\n"), "t") ==
              "s");
    }

    TEST_CASE("a unit that is not stated is taken where a second source leaves only one") {
        const std::string names = "Time,Node,ax,ay,az";
        CHECK(unit_in(guess_of(at_rest(names, 12)), "t") == "s");    // 12 ms: no usual rate
        CHECK(unit_in(guess_of(at_rest(names, 0.005)), "t") == "s"); // 5 us: too fast
        CHECK(unit_in(guess_of(at_rest(names, 5000)), "t") == "?");  // 5 s or 200 Hz
        CHECK(unit_in(guess_of(at_rest(names, 5)), "t") == "?");     // 0.2 Hz or 200 Hz
        CHECK(unit_in(guess_of("# data_rate = 200.0 Hz\n" + at_rest(names, 5)), "t") == "ms");
        CHECK(unit_in(guess_of("# Update Rate: 0.2Hz\n" + at_rest(names, 5)), "t") == "s");
        CHECK(unit_in(guess_of(at_rest(names, 5), {.duration = 24}), "t") == "s");
        CHECK(unit_in(guess_of(at_rest(names, 5), {.duration = 0.024}), "t") == "ms");
        for (const auto& [start, step, unit] : {std::tuple{1718600000, "12", "s"},
                                                {1718600000, "005", "ms"},
                                                {1718600000, "005000", "us"},
                                                {1718600000, "005000000", "ns"}}) { // dates
            std::string text = names + "\n";
            for (int k = 0; k < 6; ++k) {
                const long long second = start;
                const std::string digits(std::string(step).size(), '0');
                long long t = second;
                for (std::size_t d = 0; std::string(unit) != "s" && d < digits.size(); ++d) t *= 10;
                t += std::stoll(step) * k;
                text += fmt::format("{},1,0.01,0.02,9.81\n", t);
            }
            CHECK(unit_in(guess_of(text), "t") == unit);
        }
        // gravity
        CHECK(unit_in(guess_of(at_rest("t (s)" + names.substr(4), 1, 9.79)), "az") == "m/s2");
        CHECK(unit_in(guess_of(at_rest("t (s)" + names.substr(4), 1, -1.01)), "az") == "g");
        CHECK(unit_in(guess_of(at_rest("t (s)" + names.substr(4), 1, 990)), "az") == "mg");
        CHECK(unit_in(guess_of(at_rest("t (s)" + names.substr(4), 1, 0.1)), "az") == "?");
        // the field of the earth
        CHECK(unit_in(guess_of("t [s],id,mx,my,mz\n0,1,20,5,-40\n1,1,20,5,-40\n"), "mx") == "uT");
        CHECK(unit_in(guess_of("t [s],id,mx,my,mz\n0,1,200,50,-400\n1,1,200,50,-400\n"), "mx") ==
              "mG");
        // strain of the sensors: that of the machine
        const std::string strains = "t [s],id,strain,ax,ay,az\n0,1,0,0,0,1\n600,1,0.08,0,0,1\n";
        CHECK(unit_in(guess_of(strains), "strain") == "?");
        CHECK(unit_in(guess_of(strains, {.final_strain = 0.08}), "strain") == "1");
        CHECK(unit_in(guess_of(strains, {.final_strain = 8e-4}), "strain") == "%");
        // and times: the rate of strain
        CHECK(unit_in(guess_of("t,id,strain [1],ax,ay,az\n0,1,0,0,0,1\n5,1,0.0004,0,0,1\n"), "t") ==
              "s");
    }

    TEST_CASE("a machine's stress is known by the confining pressure, its strain by the stiffness, "
              "its times by the rate of strain") {
        std::string kilo = "time,strain,q\n", si = kilo;
        for (int k = 0; k < 20; ++k) {
            const double strain = 4e-3 * k, q = 300 * (1 - std::exp(-100 * strain));
            kilo += fmt::format("{},{},{}\n", 50 * k, 100 * strain, q);
            si += fmt::format("{},{},{}\n", 50 * k, strain, 1e3 * q);
        }
        const auto in_kilo = guess_of(kilo, {.pressure = 55e3}, true),
                   in_si = guess_of(si, {.pressure = 55e3}, true);
        CHECK(unit_in(in_kilo, "deviatoric_stress_Pa") == "kPa");
        CHECK(unit_in(in_kilo, "axial_strain") == "%");
        CHECK(unit_in(in_kilo, "t") == "s");
        CHECK(unit_in(in_si, "deviatoric_stress_Pa") == "Pa");
        CHECK(unit_in(in_si, "axial_strain") == "1");
        CHECK(unit_in(guess_of(si, {}, true), "deviatoric_stress_Pa") == "?"); // no pressure
        const auto own = guess_of("axial_strain,deviatoric_stress_Pa,ring_1_radius_m\n"
                                  "0,0,75\n0.001,30,75\n",
                                  {.pressure = 55e3}, true);
        CHECK(unit_in(own, "deviatoric_stress_Pa") == "Pa"); // stated
        CHECK(unit_in(own, "ring_1_radius_m") == "m");
    }

    TEST_CASE("the header of a German logger means the same in every encoding") {
        const std::string text = "Zeit [ms];Node;ax [m/s\u00b2];ay [m/s\u00b2];az [m/s\u00b2];"
                                 "gx [\u00b0/s];gy [\u00b0/s];gz [\u00b0/s];temp [\u00b0C]\n"
                                 "0;1;0,01;0,02;9,81;0,1;0,2;0,3;21,5\n"
                                 "10;1;0,01;0,02;9,81;0,1;0,2;0,3;21,5\n";
        for (const std::string& encoding : testing::encodings()) {
            CAPTURE(encoding);
            const TemporaryDirectory folder;
            write_whole(folder / "a.csv", testing::encoded(text, encoding));
            const GuessedMap guess = guess_columns(folder / "a.csv", recording_columns());
            CHECK(guess.open.empty());
            for (const auto& [ours, unit] :
                 {std::pair{"t", "ms"}, {"ax", "m/s2"}, {"gz", "deg/s"}, {"temp", "C"}})
                CHECK(unit_in(guess, ours) == unit);
            write_whole(folder / "columns.txt", guess.map);
            SensorInfo info;
            info.id = 1;
            const auto recordings =
                read_recordings(folder / "a.csv", {info},
                                read_column_map(folder / "columns.txt", recording_columns()));
            REQUIRE(recordings[0].size() == 2);
            CHECK(recordings[0].time[1] == doctest::Approx(0.01));
            CHECK(recordings[0].rate[0].z() == doctest::Approx(0.3 * pi / 180));
            CHECK(recordings[0].temperature[0] == doctest::Approx(294.65));
        }
    }

    TEST_CASE("a vector without all of its components is refused, and a column without numbers is "
              "not taken") {
        CHECK(has(message_of<InputError>(
                      [] { (void)guess_of("t [s],id,ax [g],az [g],b\n0,1,0,1,2\n1,1,0,1,2\n"); }),
                  "expected all components of a vector, found ax, az without ay, in the columns "
                  "\"t [s]\", \"id\", \"ax [g]\", \"az [g]\", \"b\""));
        const auto guess = guess_of("time,id,t [s],ax [g],ay [g],az [g]\n"
                                    "2024-05-07,1,0,0,0,1\n2024-05-07,1,1,0,0,1\n");
        CHECK(std::ranges::count(guess.found, "t") == 1);
        CHECK(unit_in(guess, "t") == "s");
    }
}

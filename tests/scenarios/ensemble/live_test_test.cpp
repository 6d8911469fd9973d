#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "scenarios/ensemble/live_test.hpp"
#include "scenarios/ensemble/twin.hpp"
#include "scenarios/records/quality_control_report.hpp"
#include "scenarios/stream/recorded_stream.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/ensemble/logged.hpp"
#include "tests/scenarios/ensemble/steady_run.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <sys/stat.h>
#include <thread>

using namespace bris;
using bris::testing::logged;

namespace {

/// The recordings of a steady run: their folder, and the lines of their stream.
struct Recorded {
    TemporaryDirectory folder;
    std::vector<SensorInfo> infos;
    std::vector<std::string> lines;

    Recorded() {
        const ModelRun run = testing::steady_run();
        write_recorded_test(folder.path(), 55e3, testing::placed(record_sensors(run, {}, 1), run),
                            MeasuredCurves(run.curves));
        infos = read_sensor_infos(folder.path());
        lines = stream_of(folder / "55kPa", 1.2, 60);
    }
    RecordedTest read() const { return read_recorded_test(folder.path(), 55e3, infos, {}); }
};

const Recorded& recorded() {
    static const Recorded one;
    return one;
}

/// Follows a file of lines as a live test.
struct Followed {
    TemporaryDirectory folder;
    LiveSettings settings{.timeout = 2};

    std::filesystem::path write(const std::vector<std::string>& lines,
                                const char* name = "stream") const {
        std::ofstream out(folder / name);
        for (const std::string& line : lines) out << line << '\n';
        return folder / name;
    }
    std::unique_ptr<LiveTest> follow(const std::vector<std::string>& lines,
                                     const char* log = "log") const {
        return std::make_unique<LiveTest>(logged(write(lines), folder / log), recorded().infos,
                                          settings);
    }
};

void check_same(const RecordedTest& a, const RecordedTest& b) {
    REQUIRE(a.curves.size() == b.curves.size());
    for (std::size_t k = 0; k < a.curves.size(); ++k) {
        CHECK(a.curves[quantity::deviatoric_stress][k] == b.curves[quantity::deviatoric_stress][k]);
    }
    for (std::size_t r = 0; r < a.curves.rings(); ++r) CHECK(a.curves.ring(r) == b.curves.ring(r));
    REQUIRE(a.trajectories.size() == b.trajectories.size());
    for (std::size_t s = 0; s < a.trajectories.size(); ++s) {
        CHECK(a.trajectories[s].strain == b.trajectories[s].strain);
        CHECK(a.trajectories[s].displacement == b.trajectories[s].displacement);
        CHECK(a.trajectories[s].rotation == b.trajectories[s].rotation);
    }
}

std::string with(const std::string& line, const std::string& what, const std::string& instead) {
    const auto at = line.find(what);
    return at == std::string::npos ? line
                                   : line.substr(0, at) + instead + line.substr(at + what.size());
}

/// A record of the machine with one of its numbers changed; any other line as it is.
std::string changed(const std::string& line, const std::string& name, auto&& change) {
    const auto at = line.find("\"" + name + "\": "), strain = line.find("\"axial_strain\": ");
    if (at == std::string::npos || strain == std::string::npos) return line;
    const auto begin = at + name.size() + 4, end = line.find_first_of(",}", begin);
    const long stage = std::lround(1e4 * std::stod(line.substr(strain + 16)));
    return line.substr(0, begin) + fmt::format("{}", change(std::stod(line.substr(begin)), stage)) +
           line.substr(end);
}

std::string without_strain(std::string line) {
    if (const auto at = line.find("\"strain\": "); at != std::string::npos)
        line.erase(at, line.find(", ", at) + 2 - at);
    return line;
}
std::string ahead_by(double seconds, const std::string& line) {
    const auto at = line.find("\"t\": ") + 5, end = line.find_first_of(",}", at);
    return line.substr(0, at) +
           fmt::format("{:.6f}", std::stod(line.substr(at, end - at)) + seconds) + line.substr(end);
}

bool of_sensor(const std::string& line, int id) {
    return line.find("\"id\": " + std::to_string(id)) != std::string::npos;
}

} // namespace

TEST_SUITE("ensemble/live_test") {
    TEST_CASE(
        "a test followed to its end equals the test read from its files, and no record is used "
        "before its strain") {
        const Followed f;
        const auto test = f.follow(recorded().lines);
        REQUIRE(test->follow_to(0.004));
        const RecordedTest before = test->so_far();
        CHECK(before.curves[quantity::axial_strain].back() == about(0.004));
        CHECK(before.trajectories[1].strain.back() == about(0.004));
        CHECK(test->ages().size() == 3 * 5 + 3 * 4 + 41);
        CHECK(test->ages().empty());
        REQUIRE(test->follow_to(0.01));
        check_same(test->so_far(), recorded().read());
        CHECK_FALSE(test->follow_to(0.02));
        CHECK(test->over());
        CHECK(test->report().find("the sender ended the test") != std::string::npos);
    }

    TEST_CASE("records may arrive late, out of order and twice: the test is the same, and the "
              "report counts them") {
        std::vector<std::string> lines;
        std::string held;
        for (const std::string& line : recorded().lines) {
            lines.push_back(line);
            if (!of_sensor(line, 2)) continue;
            lines.back() = held.empty() ? line : held; // each arrives when the next one is due
            if (!held.empty()) lines.push_back(held);  // and is sent again
            held = line;
        }
        lines.insert(lines.end() - 1, held);
        const Followed f;
        const auto test = f.follow(lines);
        for (int k = 0; k <= 100; ++k) REQUIRE(test->follow_to(1e-4 * k));
        CHECK(test->so_far().trajectories[1].strain.size() ==
              9); // the last one arrives after the end
        CHECK_FALSE(test->follow_to(0.02));
        check_same(test->so_far(), recorded().read());
        CHECK(test->report().find("sensor 2: 15 records, 10 late, 15 sent again") !=
              std::string::npos);
    }

    TEST_CASE("a run that was stopped resumes from its log to the same test, whether the lines are "
              "sent again or not") {
        const Followed f;
        {
            const auto test = f.follow(recorded().lines);
            REQUIRE(test->follow_to(0.004));
        }
        std::ofstream(f.folder / "log", std::ios::app)
            << "{\"id\": 1, \"t\"";         // stopped while writing a line
        std::vector<std::string> remaining; // from a sender that does not repeat lines
        for (std::size_t k = 0; k < recorded().lines.size(); ++k)
            if (k >= 3 * 5 + 3 * 4 + 41) remaining.push_back(recorded().lines[k]);
        std::filesystem::copy_file(f.folder / "log", f.folder / "log2");
        const auto going_on = f.follow(remaining, "log2");
        REQUIRE(going_on->follow_to(0.004));
        CHECK(going_on->so_far().curves[quantity::axial_strain].back() == about(0.004));
        (void)going_on->follow_to(1);
        check_same(going_on->so_far(), recorded().read());
        const auto all = std::make_unique<LiveTest>(
            logged(f.write(recorded().lines), f.folder / "log"), recorded().infos, f.settings);
        (void)all->follow_to(1);
        check_same(all->so_far(), recorded().read());
        // the log alone contains the whole test
        const auto again = std::make_unique<LiveTest>(logged(f.write({}), f.folder / "log"),
                                                      recorded().infos, f.settings);
        CHECK_FALSE(again->follow_to(1));
        CHECK(again->report().find("the sender ended the test") != std::string::npos);
        check_same(again->so_far(), recorded().read());
    }

    TEST_CASE(
        "a sensor that does not send strain is given the strain of the test machine by its clock") {
        std::vector<std::string> lines;
        for (const std::string& line : recorded().lines) lines.push_back(without_strain(line));
        const Followed f;
        const auto test = f.follow(lines);
        (void)test->follow_to(1);
        const RecordedTest found = test->so_far(), expected = recorded().read();
        for (std::size_t s = 0; s < 3; ++s) {
            // its clock is fast, so its last record is after the machine's last
            REQUIRE(found.trajectories[s].strain.size() + 1 ==
                    expected.trajectories[s].strain.size());
            for (std::size_t k = 0; k < found.trajectories[s].strain.size(); ++k)
                CHECK(found.trajectories[s].strain[k] ==
                      about(expected.trajectories[s].strain[k]).epsilon(1e-3));
        }
    }

    TEST_CASE(
        "the test in assets/smartrock is accepted at every strain when it is followed, with and "
        "without the sensors' strains") {
        const std::filesystem::path folder = assets_folder() / "smartrock";
        for (const bool strain : {true, false}) {
            std::vector<std::string> lines = stream_of(folder / "55kPa", 1.2, 60);
            if (!strain)
                for (std::string& line : lines) line = without_strain(line);
            const Followed f;
            LiveTest test(logged(f.write(lines), f.folder / "log"), read_sensor_infos(folder),
                          f.settings);
            for (int k = 0; k <= 80; k += 4) {
                REQUIRE(test.follow_to(1e-3 * k));
                const RecordedTest now = test.so_far();
                INFO(k << "\n" << quality_control_report(now.findings, now.recordings));
                CHECK(now.refused() == 0);
                for (const Finding& finding : now.findings)
                    CHECK((finding.text.find("the clock runs fast") != std::string::npos ||
                           finding.text.find("too few samples at rest") != std::string::npos));
            }
        }
    }

    TEST_CASE("a sensor that does not send strain and whose clock is ahead of the machine's is "
              "refused because of its clock") {
        for (const double ahead : {10.0, 100.0}) {
            std::vector<std::string> lines;
            for (const std::string& line : recorded().lines)
                lines.push_back(of_sensor(line, 2) ? ahead_by(ahead, without_strain(line))
                                                   : without_strain(line));
            const Followed f;
            const auto test = f.follow(lines);
            REQUIRE(test->follow_to(0.01));
            CHECK(test->so_far().refused() == 1);
            CHECK(test->so_far().trajectories[1].strain.empty());
            // 1.2 s more, since a sample arrives before the machine's record of that stage
            CHECK(test->report().find(fmt::format("sensor 2: refused: clock: t is {:.3g} s "
                                                  "ahead of the machine's on arrival",
                                                  ahead + 1.2)) != std::string::npos);
            // a clock offset in the metadata corrects it
            auto infos = recorded().infos;
            infos[1].clock_offset = ahead;
            LiveTest replayed(logged(f.write(lines, "again"), f.folder / "log2"), infos,
                              f.settings);
            REQUIRE(replayed.follow_to(0.01));
            CHECK(replayed.so_far().refused() == 0);
            REQUIRE(replayed.so_far().trajectories[1].strain.size() == 9);
            CHECK(replayed.so_far().trajectories[1].strain[4] == about(0.005).epsilon(1e-3));
        }
    }

    TEST_CASE("a sensor whose times are outside the machine's is refused because of its clock, not "
              "because its recording is empty") {
        std::vector<std::string> lines;
        for (const std::string& line : recorded().lines)
            lines.push_back(of_sensor(line, 3) ? ahead_by(1e6, without_strain(line)) : line);
        const Followed f;
        const auto test = f.follow(lines);
        REQUIRE(test->follow_to(0.01));
        CHECK(test->report().find("sensor 3: refused: clock: t is 1e+06 s ahead") !=
              std::string::npos);
        CHECK(test->report().find("length") == std::string::npos);
        std::vector<std::string> timeless; // the machine sends no t either
        for (const std::string& line : lines)
            timeless.push_back(line.find("axial_strain") == std::string::npos
                                   ? line
                                   : with(line, "\"t\"", "\"clock\""));
        const auto other = f.follow(timeless, "log2");
        REQUIRE(other->follow_to(0.01));
        CHECK(other->report().find("sensor 3: refused: clock: expected strain in its records, or t "
                                   "in the machine's, found neither") != std::string::npos);
    }

    TEST_CASE(
        "a wrong clock is reported, but does no harm if strain is sent; without strain, one that "
        "is behind is refused where the rock moves before the test begins") {
        std::vector<std::string> lines, behind;
        for (const std::string& line : recorded().lines) {
            lines.push_back(of_sensor(line, 2) ? ahead_by(100, line) : line);
            behind.push_back(of_sensor(line, 3) ? ahead_by(-100, without_strain(line)) : line);
        }
        const Followed f;
        const auto test = f.follow(lines);
        REQUIRE(test->follow_to(0.01));
        CHECK(test->so_far().refused() == 0);
        CHECK(test->so_far().trajectories[1].strain.size() == 10);
        CHECK(test->report().find(
                  "sensor 2: clock: t is 100 s ahead of the machine's at the same strain") !=
              std::string::npos);
        const auto late = f.follow(behind, "log2");
        REQUIRE(late->follow_to(0.01));
        CHECK(late->report().find("s behind the machine's on arrival, expected 4.2 s at most: "
                                  "wrong clock, or late records") != std::string::npos);
        CHECK(late->report().find("sensor 3: refused: clock: the rock moves by") !=
              std::string::npos);
    }

    TEST_CASE("records that cannot be used are reported, and the test continues without them") {
        std::vector<std::string> lines{
            "garbage",
            "{\"id\": 99, \"t\": 1}",
            "{\"id\": 1.5, \"t\": 1}",
            "{\"id\": 1}",
            "{\"note\": 3}",
            "{\"axial_strain\": 0.5, \"deviatoric_stress_Pa\": \"nan\"}"};
        for (const std::string& line : recorded().lines) {
            if (of_sensor(line, 1))
                lines.push_back(
                    with(with(with(line, "\"ax\": ", "\"ax_g\": "), "\"ay\": ", "\"ax\": "),
                         "\"ax_g\": ", "\"ay\": ")); // other axes
            else if (of_sensor(line, 3))
                lines.push_back(
                    with(line, "\"ax\": ", "\"gx_is\": ")); // a vector without one component
            else
                lines.push_back(line);
        }
        lines.push_back(lines.back());
        const Followed f;
        const auto test = f.follow(lines);
        REQUIRE(test->follow_to(0.01));
        const RecordedTest found = test->so_far();
        CHECK(found.refused() == 2);
        CHECK(found.trajectories[0].strain.empty());
        CHECK(found.trajectories[2].strain.empty());
        CHECK(found.trajectories[1].displacement == recorded().read().trajectories[1].displacement);
        const std::string report = test->report();
        for (const char* what :
             {"line 1: expected a JSON object or the names of columns, found \"garbage\"",
              "expected the id of a file rock_NN.txt, found 99", "found 1.5",
              "sensor 1: t: expected a number", "expected an id, or axial_strain",
              "expected numbers, found 0.5 and nan", "sensor 1: refused: frame",
              "sensor 3: refused: numbers"}) {
            CAPTURE(what);
            CHECK(report.find(what) != std::string::npos);
        }
    }

    TEST_CASE("faulty records of the machine are left out with a reason as soon as the fault is "
              "evident, and the test continues without them") {
        struct Fault {
            const char* channel;
            double (*change)(double number, long stage);
            double shows; ///< axial strain
            const char* says;
            std::size_t left_out; ///< in the end
        };
        const Fault faults[] = {
            {"deviatoric_stress_Pa", [](double q, long k) { return k == 15 ? 1e12 : q; }, 0.0015,
             "deviatoric_stress_Pa: 1 of 16 records left out: expected -5.5e+04 to 1.65e+06, found "
             "1e+12 at 0.15 %",
             1},
            {"deviatoric_stress_Pa", [](double q, long k) { return k == 15 ? 10 * q : q; }, 0.0016,
             "deviatoric_stress_Pa: 1 of 17 records left out: expected a value near 5.507e+04 as "
             "in neighbouring records, found 5.276e+05",
             1},
            {"deviatoric_stress_Pa", [](double q, long) { return 1e-3 * q; }, 0.0022,
             "refused: deviatoric_stress_Pa: expected at least 1100 Pa beyond 0.2 % of axial "
             "strain",
             101},
            {"deviatoric_stress_Pa", [](double q, long) { return -q; }, 0.0005,
             "refused: deviatoric_stress_Pa: expected positive values in compression", 101},
            {"deviatoric_stress_Pa", [](double q, long k) { return k > 50 ? 8e4 : q; }, 0.0062,
             "deviatoric_stress_Pa: 11 of 63 records left out: expected a change, found 8e+04 from "
             "0.51 to 0.62 %",
             49},
            {"volumetric_strain",
             [](double, long k) { return -0.5 * 0.01 * static_cast<double>(k); }, 0.0004,
             "refused: volumetric_strain: ", 101},
            {"volumetric_strain", [](double v, long k) { return k == 40 ? 7.0 : v; }, 0.004,
             "volumetric_strain: 1 of 41 records left out: expected -0.021 to 0.005, found 7 at "
             "0.4 %",
             1},
            {"ring_2_radius_m", [](double r, long k) { return k == 100 ? -r : r; }, 0.01,
             "ring_2_radius_m: 1 of 101 records left out: expected", 1},
        };
        for (const Fault& fault : faults) {
            CAPTURE(fault.says);
            std::vector<std::string> lines;
            for (const std::string& line : recorded().lines)
                lines.push_back(changed(line, fault.channel, fault.change));
            const Followed f;
            const auto test = f.follow(lines);
            REQUIRE(test->follow_to(fault.shows));
            const std::string report = test->report();
            CAPTURE(report);
            CHECK(report.find(fault.says) != std::string::npos);
            REQUIRE(test->follow_to(0.01)); // the test does not end there
            const RecordedTest found = test->so_far(), good = recorded().read();
            REQUIRE(found.curves.size() == good.curves.size());
            CHECK(found.refused() == 0);
            CHECK(found.trajectories[1].displacement == good.trajectories[1].displacement);
            std::size_t left_out = 0;
            bool rest_is_same = true;
            const auto compare = [&](double a, double b) {
                if (std::isnan(a))
                    ++left_out;
                else
                    rest_is_same = rest_is_same && a == b;
            };
            for (std::size_t k = 0; k < found.curves.size(); ++k) {
                const auto at = [k](const RecordedTest& of, const Quantity& q) {
                    return of.curves[q][k];
                };
                const double q = at(found, quantity::deviatoric_stress);
                compare(q, k == 51 && q == 8e4 // the first record of a constant run is valid
                               ? 8e4
                               : at(good, quantity::deviatoric_stress));
                compare(at(found, quantity::volumetric_strain),
                        at(good, quantity::volumetric_strain));
                for (std::size_t r = 0; r < 8; ++r)
                    compare(found.curves.ring(r)[k], good.curves.ring(r)[k]);
            }
            CHECK(rest_is_same);
            CHECK(left_out == fault.left_out);
        }
    }

    TEST_CASE("the machine of the example passes quality control at any time of the test") {
        const std::filesystem::path example = assets_folder() / "smartrock";
        for (const char* pressure : {"55", "110", "165"}) {
            const auto all = stream_of(example / (std::string(pressure) + "kPa"), 1.2, 60);
            const Followed f;
            LiveSettings settings = f.settings;
            settings.pressure = 1e3 * std::stod(pressure);
            LiveTest test(logged(f.write(all), f.folder / "log"), read_sensor_infos(example),
                          settings);
            for (const double strain : {0.0, 1e-4, 3e-4, 1e-3, 2e-3, 5e-3, 0.0098, 0.01, 0.0428,
                                        0.0516, 0.0721, 0.08}) { // also where it slips
                CAPTURE(strain);
                REQUIRE(test.follow_to(strain));
                CHECK(test.report().find(fmt::format("test machine: accepted, {} records\n",
                                                     std::lround(1e4 * strain) + 1)) !=
                      std::string::npos);
            }
        }
    }

    TEST_CASE("a stream without records for the timeout has ended, and a run resumed from its log "
              "listens again") {
        std::vector<std::string> half(recorded().lines.begin(), recorded().lines.begin() + 80);
        Followed f;
        f.settings.timeout = 0.1;
        {
            const auto test = f.follow(half);
            CHECK_FALSE(test->follow_to(0.01));
            CHECK(test->over());
            CHECK(test->report().find(
                      "no record of the test machine arrived for 0.1 s after 80 lines") !=
                  std::string::npos);
        }
        f.settings.timeout = 2;
        LiveTest again(logged(f.write(recorded().lines), f.folder / "log"), recorded().infos,
                       f.settings);
        REQUIRE(again.follow_to(0.01));
        check_same(again.so_far(), recorded().read());
    }

    TEST_CASE(
        "a resumed run has at each strain the records that had arrived then, not later ones") {
        std::vector<std::string> lines;
        std::vector<std::string> late;
        for (const std::string& line : recorded().lines) {
            if (of_sensor(line, 2) && line.find("strain\": 0.001") != std::string::npos)
                late.push_back(line); // arrives at 0.5 %
            else
                lines.push_back(line);
            if (line.find("\"axial_strain\": 0.005,") != std::string::npos)
                lines.insert(lines.end(), late.begin(), late.end());
        }
        REQUIRE(late.size() == 1);
        const Followed f;
        std::vector<RecordedTest> first;
        {
            const auto test = f.follow(lines);
            for (int k = 1; k <= 7; ++k) {
                REQUIRE(test->follow_to(1e-3 * k));
                first.push_back(test->so_far());
            }
        }
        CHECK(first[2].trajectories[1].strain.size() == 2);
        CHECK(first[6].trajectories[1].strain.size() == 7);
        const auto again = f.follow(lines);
        for (int k = 1; k <= 7; ++k) {
            REQUIRE(again->follow_to(1e-3 * k));
            check_same(again->so_far(), first[static_cast<std::size_t>(k - 1)]);
        }
        CHECK(again->ages().empty()); // all from the log
    }

    TEST_CASE("a single wrong strain is not taken for the end of the test") {
        std::vector<std::string> lines = recorded().lines;
        lines.insert(lines.begin() + 60, {R"({"axial_strain": 0.5, "deviatoric_stress_Pa": 1e5})",
                                          R"({"id": 1, "t": 70.5, "strain": 0.5})"});
        const Followed f;
        const auto test = f.follow(lines);
        REQUIRE(test->follow_to(0.004));
        CHECK(test->so_far().curves[quantity::axial_strain].back() == about(0.004));
        (void)test->follow_to(1);
        check_same(test->so_far(), recorded().read());
        CHECK(test->report().find("the machine: expected an axial strain near") !=
              std::string::npos);
    }

    TEST_CASE("copies of one impossible record change nothing, however many there are") {
        for (const int copies : {1, 2, 3, 100}) {
            CAPTURE(copies);
            std::vector<std::string> lines = recorded().lines;
            const auto at = std::ranges::find_if(lines, [](const std::string& line) {
                return line.find("\"axial_strain\": 0.0004") != std::string::npos;
            });
            REQUIRE(at != lines.end());
            lines.insert(at, static_cast<std::size_t>(copies),
                         R"({"t": 80, "axial_strain": 0.5, "deviatoric_stress_Pa": 1e4})");
            const Followed f;
            const auto test = f.follow(lines);
            for (int k = 0; k <= 100; ++k) {
                REQUIRE(test->follow_to(1e-4 * k));
                CHECK(test->so_far().curves.size() == static_cast<std::size_t>(k + 1));
            }
            (void)test->follow_to(1);
            check_same(test->so_far(), recorded().read());
            CHECK(test->report().find(fmt::format("{} time{}: ", copies, copies == 1 ? "" : "s") +
                                      "line") != std::string::npos);
        }
    }

    TEST_CASE("one wrong time of the machine changes nothing, whether it is early or late") {
        for (const double wrong : {0.0, 1e9, -5e8}) {
            CAPTURE(wrong);
            std::vector<std::string> lines;
            for (const std::string& line : recorded().lines)
                lines.push_back(changed(without_strain(line), "t", [&](double t, long stage) {
                    return stage == 20 ? wrong : t;
                }));
            const Followed f;
            const auto test = f.follow(lines);
            (void)test->follow_to(1);
            const auto found = test->so_far();
            CHECK(found.refused() == 0);
            const RecordedTest expected = recorded().read();
            for (std::size_t s = 0; s < 3; ++s) {
                REQUIRE(found.trajectories[s].strain.size() + 1 ==
                        expected.trajectories[s].strain.size());
                for (std::size_t k = 0; k < found.trajectories[s].strain.size(); ++k)
                    CHECK(found.trajectories[s].strain[k] ==
                          about(expected.trajectories[s].strain[k]).epsilon(1e-3));
            }
        }
    }

    TEST_CASE("fields that nobody uses change nothing, and the report names them once") {
        std::vector<std::string> lines;
        for (const std::string& line : recorded().lines)
            lines.push_back(line.find("\"end\"") != std::string::npos
                                ? line
                                : R"({"fw": "1.2.3", "ok": true, "where": {"t": [NaN]}, )" +
                                      line.substr(1));
        const Followed f;
        const auto test = f.follow(lines);
        (void)test->follow_to(1);
        check_same(test->so_far(), recorded().read());
        CHECK(test->report().find("fields that nobody uses are ignored: fw, ok, where\n") !=
              std::string::npos);
    }

    TEST_CASE("a test that came through a pipe is the same again from its log, at every strain") {
        const Followed f;
        const auto pipe = f.folder / "pipe";
        REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
        std::vector<std::string> lines = recorded().lines;
        std::swap(lines[70], lines[75]);
        lines.insert(lines.begin() + 60,
                     {"junk \xff", R"({"t": 81, "axial_strain": 0.5, "deviatoric_stress_Pa": 1})"});
        std::thread sender([&] {
            std::ofstream out(pipe);
            for (const std::string& line : lines) out << line << '\n' << std::flush;
            out << "{\"id\": 1, \"t\""; // cut off by the end of the stream
        });
        std::vector<RecordedTest> live;
        std::string report;
        {
            LiveTest test(logged(pipe, f.folder / "log"), recorded().infos, f.settings);
            for (int k = 0; k <= 10; ++k) {
                REQUIRE(test.follow_to(1e-3 * k));
                live.push_back(test.so_far());
            }
            (void)test.follow_to(1);
            report = test.report();
        }
        sender.join();
        LiveTest again(open_lines(f.folder / "log"), recorded().infos, f.settings);
        for (int k = 0; k <= 10; ++k) {
            REQUIRE(again.follow_to(1e-3 * k));
            check_same(again.so_far(), live[static_cast<std::size_t>(k)]);
        }
        (void)again.follow_to(1);
        CHECK(again.report() == report);
    }

    TEST_CASE("a machine that sends its strain in per cent does not end the test") {
        std::vector<std::string> lines;
        for (int k = 0; k < 40; ++k)
            lines.push_back(fmt::format(R"({{"axial_strain": {}, "deviatoric_stress_Pa": {}}})",
                                        0.01 * k, 1e3 * k)); // stages of 0.01 %
        lines.emplace_back(R"({"end": 1})");
        const Followed f;
        const auto test = f.follow(lines);
        CHECK_FALSE(test->follow_to(0.01));
        CHECK(test->so_far().curves.size() == 1); // 0
        CHECK(test->report().find("is it in per cent?") != std::string::npos);
    }

    TEST_CASE("a test continues after an outage, once three records of the machine agree on the "
              "strain") {
        std::vector<std::string> lines;
        for (const std::string& line : recorded().lines) {
            const auto at = line.find("axial_strain\": ");
            const double strain = at == std::string::npos ? 0 : std::stod(line.substr(at + 15));
            if (strain > 0.0015 && strain < 0.0055) continue; // more than 0.2 % of strain is lost
            lines.push_back(line);
        }
        const Followed f;
        const auto test = f.follow(lines);
        REQUIRE(test->follow_to(0.008));
        const RecordedTest measured = test->so_far();
        CHECK(std::ranges::count_if(measured.curves[quantity::axial_strain], [](double strain) {
                  return strain > 0.0055 && strain < 0.0065;
              }) > 0);
        CHECK(test->report().find("the machine continues at an axial strain of 0.0055") !=
              std::string::npos);
    }

    TEST_CASE("a machine without records for the timeout ends the test, even if sensors continue") {
        Followed f;
        f.settings.timeout = 0.3;
        const auto path = f.write({R"({"axial_strain": 0, "deviatoric_stress_Pa": 0})"});
        std::atomic<bool> over = false;
        std::thread sensor([&] {
            for (int k = 0; !over && k < 200; ++k) {
                std::ofstream(path, std::ios::app)
                    << fmt::format(R"({{"id": 1, "t": {}}})", 0.01 * k) << std::endl;
                std::this_thread::sleep_for(std::chrono::milliseconds(20));
            }
        });
        LiveTest test(logged(path, f.folder / "log"), recorded().infos, f.settings);
        const Instant began = this_instant();
        CHECK_FALSE(test.follow_to(0.01));
        over = true;
        sensor.join();
        CHECK(seconds_since(began) < 2);
        CHECK(test.report().find("no record of the test machine arrived for 0.3 s") !=
              std::string::npos);
    }

    TEST_CASE(
        "lines that arrived but were not processed are logged when a run stops, and a cut-off "
        "line remains one") {
        const Followed f;
        {
            const auto test = f.follow(recorded().lines);
            REQUIRE(test->follow_to(0.001));
            std::this_thread::sleep_for(std::chrono::milliseconds(300)); // all are read meanwhile
        }
        const auto again = std::make_unique<LiveTest>(logged(f.write({}), f.folder / "log"),
                                                      recorded().infos, f.settings);
        (void)again->follow_to(1);
        check_same(again->so_far(), recorded().read());
    }

    TEST_CASE("a replay runs at the requested speed") {
        Followed f;
        f.settings.speed = 1000; // 180 s of rest and test
        const auto test = f.follow(recorded().lines);
        const Instant began = this_instant();
        REQUIRE(test->follow_to(0.01));
        CHECK(seconds_since(began) > 0.1);
    }

    TEST_CASE(
        "a stream has the channels of recordings: field, temperature, battery, and flags that "
        "reject a record") {
        const Followed f;
        std::vector<std::string> lines;
        int record = 0;
        for (const std::string& line : recorded().lines) {
            lines.push_back(line);
            if (!of_sensor(line, 2)) continue;
            const std::string flags = ++record == 9
                                          ? "\"flags\": 4, \"ux\": 77, "
                                          : "\"flags\": 0, "; // the flagged record is an outlier
            std::string clean = record == 9 ? with(line, "\"ux\"", "\"other\"") : line;
            lines.back() =
                "{" + flags +
                fmt::format("\"temp\": {}, \"batt\": 3.1, \"mx\": 20, \"my\": 0.5, \"mz\": -44, ",
                            20 + record) +
                clean.substr(1);
        }
        const auto test = f.follow(lines);
        REQUIRE(test->follow_to(0.01));
        const std::string report = test->report();
        INFO(report);
        const RecordedTest now = test->so_far();
        CHECK(now.refused() == 0);
        CHECK(now.recordings[1].size() == recorded().read().recordings[1].size() - 1);
        CHECK(report.find("sensor 2: flags: 1 of 15 samples are left out") != std::string::npos);
        CHECK(report.find("sensor 2: temperature: 21.0 to 35.0 C") != std::string::npos);
        CHECK(report.find("sensor 2: battery: low in 14 of 14 samples") != std::string::npos);
        CHECK(report.find("sensor 2: field: yaw is not observable: expected noise, found a "
                          "constant field") != std::string::npos);
        CHECK(report.find("sensor 1: field") == std::string::npos);
        CHECK(now.trajectories[0].displacement == recorded().read().trajectories[0].displacement);
    }

    TEST_CASE("different faults of a stream are listed apart, each with its number and its first "
              "line, and bytes that control a terminal are escaped") {
        const Followed f;
        std::vector<std::string> lines = recorded().lines;
        for (const char* bad : {"{\"t\": 1", "{\"t\": 2", "junk \x1b[31m \xff", "{\"t\": \"one\"}",
                                "{\"t\": \"two\"}", "{\"t\": \"three\"}"})
            lines.insert(lines.begin() + 4, bad);
        const auto test = f.follow(lines);
        REQUIRE(test->follow_to(0.01));
        const std::string report = test->report();
        INFO(report);
        const auto has = [&](const char* part) { return report.find(part) != std::string::npos; };
        CHECK(has("2 times: line 9: expected an object of JSON, found"));
        CHECK(has("1 time: line 8: expected a JSON object or the names of columns, found \"junk "
                  "\\x1b[31m \\xff\""));
        CHECK(has("3 times: line 5: t: expected a number, found"));
        CHECK(report.find('\x1b') == std::string::npos);
    }

    TEST_CASE("entries of a stream that are not numbers are reported with their line, and a record "
              "without strain is placed by its clock") {
        const Followed f;
        std::vector<std::string> lines;
        int record = 0;
        std::size_t bad = 0;
        for (const std::string& line : recorded().lines) {
            lines.push_back(line);
            if (!of_sensor(line, 2) || ++record != 9) continue;
            const auto at = line.find("\"strain\": "), end = line.find(",", at);
            lines.back() = line.substr(0, at) + "\"strain\": \"nan\"" + line.substr(end);
            bad = lines.size();
        }
        const auto test = f.follow(lines);
        REQUIRE(test->follow_to(0.01));
        INFO(test->report());
        CHECK(test->report().find(fmt::format(
                  "1 time: line {}: sensor 2: strain: expected a number, found nan", bad)) !=
              std::string::npos);
        CHECK(test->so_far().trajectories[0].displacement ==
              recorded().read().trajectories[0].displacement);
    }
}

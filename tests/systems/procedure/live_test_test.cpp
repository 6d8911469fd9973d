#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "systems/procedure/live_test.hpp"
#include "systems/procedure/recorded_stream.hpp"
#include "systems/procedure/twin.hpp"
#include "tests/about.hpp"
#include "tests/systems/procedure/steady_run.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <thread>

using namespace bris;

namespace {

/// A steady run, recorded; its folder and its lines.
struct Recorded {
    TemporaryDirectory folder;
    std::vector<SensorInfo> infos;
    std::vector<std::string> lines;

    Recorded() {
        const ModelRun run = testing::steady_run();
        write_recorded_test(folder.path(), 55e3, record_sensors(run, {}, 1), testing::scene_of(run), run.points);
        infos = read_sensor_infos(folder.path());
        lines = stream_of(folder / "55kPa", 1.2, 60);
    }
    RecordedTest read() const { return read_recorded_test(folder.path(), 55e3, infos, {}); }
};

const Recorded& recorded() {
    static const Recorded one;
    return one;
}

/// A file of lines, followed.
struct Followed {
    TemporaryDirectory folder;
    LiveSettings settings{.patience = 2};

    std::filesystem::path write(const std::vector<std::string>& lines, const char* name = "stream") const {
        std::ofstream out(folder / name);
        for (const std::string& line : lines) out << line << '\n';
        return folder / name;
    }
    std::unique_ptr<LiveTest> follow(const std::vector<std::string>& lines, const char* log = "log") const {
        return std::make_unique<LiveTest>(write(lines), folder / log, recorded().infos, settings);
    }
};

void check_same(const RecordedTest& a, const RecordedTest& b) {
    REQUIRE(a.measured.size() == b.measured.size());
    for (std::size_t k = 0; k < a.measured.size(); ++k) {
        CHECK(a.measured[k].deviatoric_stress == b.measured[k].deviatoric_stress);
        CHECK(a.measured[k].ring_radius == b.measured[k].ring_radius);
    }
    REQUIRE(a.ways.size() == b.ways.size());
    for (std::size_t s = 0; s < a.ways.size(); ++s) {
        CHECK(a.ways[s].strain == b.ways[s].strain);
        CHECK(a.ways[s].displacement == b.ways[s].displacement);
        CHECK(a.ways[s].rotation == b.ways[s].rotation);
    }
}

std::string with(const std::string& line, const std::string& what, const std::string& instead) {
    const auto at = line.find(what);
    return at == std::string::npos ? line : line.substr(0, at) + instead + line.substr(at + what.size());
}

bool of_sensor(const std::string& line, int id) { return line.find("\"id\": " + std::to_string(id)) != std::string::npos; }

} // namespace

TEST_SUITE("procedure/live_test") {
    TEST_CASE("a test followed to its end is the test that its files tell of, and no record is known before its strain") {
        const Followed f;
        const auto test = f.follow(recorded().lines);
        REQUIRE(test->follow_to(0.004));
        const RecordedTest before = test->so_far();
        CHECK(before.measured.back().axial_strain == about(0.004));
        CHECK(before.ways[1].strain.back() == about(0.004));
        CHECK(test->ages().size() == 3 * 5 + 3 * 4 + 41);
        CHECK(test->ages().empty());
        REQUIRE(test->follow_to(0.01));
        check_same(test->so_far(), recorded().read());
        CHECK_FALSE(test->follow_to(0.02));
        CHECK(test->over());
        CHECK(test->report().find("the sender ended it") != std::string::npos);
    }

    TEST_CASE("records may come late, out of order and twice: the test is the same, and the report counts them") {
        std::vector<std::string> lines;
        std::string held;
        for (const std::string& line : recorded().lines) {
            lines.push_back(line);
            if (!of_sensor(line, 2)) continue;
            lines.back() = held.empty() ? line : held; // each when the next one is due
            if (!held.empty()) lines.push_back(held);  // and again
            held = line;
        }
        lines.insert(lines.end() - 1, held);
        const Followed f;
        const auto test = f.follow(lines);
        for (int k = 0; k <= 100; ++k) REQUIRE(test->follow_to(1e-4 * k));
        CHECK(test->so_far().ways[1].strain.size() == 9); // the last one comes after all
        CHECK_FALSE(test->follow_to(0.02));
        check_same(test->so_far(), recorded().read());
        CHECK(test->report().find("sensor 2: 15 records, 10 late, 15 sent again") != std::string::npos);
    }

    TEST_CASE("a run that was stopped goes on from its log to the same test, whether it is sent again or not") {
        const Followed f;
        {
            const auto test = f.follow(recorded().lines);
            REQUIRE(test->follow_to(0.004));
        }
        std::ofstream(f.folder / "log", std::ios::app) << "{\"id\": 1, \"t\""; // it was stopped while it wrote
        std::vector<std::string> rest; // from a sender that knows what has come
        for (std::size_t k = 0; k < recorded().lines.size(); ++k)
            if (k >= 3 * 5 + 3 * 4 + 41) rest.push_back(recorded().lines[k]);
        std::filesystem::copy_file(f.folder / "log", f.folder / "log2");
        const auto going_on = f.follow(rest, "log2");
        REQUIRE(going_on->follow_to(0.004));
        CHECK(going_on->so_far().measured.back().axial_strain == about(0.004));
        (void)going_on->follow_to(1);
        check_same(going_on->so_far(), recorded().read());
        const auto all = std::make_unique<LiveTest>(f.write(recorded().lines), f.folder / "log", recorded().infos, f.settings);
        (void)all->follow_to(1);
        check_same(all->so_far(), recorded().read());
        // and the log alone is all of it
        const auto again = std::make_unique<LiveTest>(f.write({}), f.folder / "log", recorded().infos, f.settings);
        CHECK_FALSE(again->follow_to(1));
        CHECK(again->report().find("the sender ended it") != std::string::npos);
        check_same(again->so_far(), recorded().read());
    }

    TEST_CASE("a sensor that knows no strain gets it from the test machine's clock") {
        std::vector<std::string> lines;
        for (std::string line : recorded().lines) {
            if (const auto at = line.find("\"strain\": "); at != std::string::npos) line.erase(at, line.find(", ", at) + 2 - at);
            lines.push_back(line);
        }
        const Followed f;
        const auto test = f.follow(lines);
        (void)test->follow_to(1);
        const RecordedTest found = test->so_far(), expected = recorded().read();
        for (std::size_t s = 0; s < 3; ++s) {
            REQUIRE(found.ways[s].strain.size() + 1 == expected.ways[s].strain.size()); // its clock is fast: the last one is after the machine's last
            for (std::size_t k = 0; k < found.ways[s].strain.size(); ++k) CHECK(found.ways[s].strain[k] == about(expected.ways[s].strain[k]).epsilon(1e-3));
        }
    }

    TEST_CASE("what cannot be used is let be and reported, and the test goes on without it") {
        std::vector<std::string> lines{"garbage", "{\"id\": 99, \"t\": 1}", "{\"id\": 1.5, \"t\": 1}", "{\"id\": 1}", "{\"note\": 3}", "{\"axial_strain\": 0.5, \"deviatoric_stress_Pa\": \"nan\"}"};
        for (const std::string& line : recorded().lines) {
            if (of_sensor(line, 1)) lines.push_back(with(with(with(line, "\"ax\": ", "\"ax_g\": "), "\"ay\": ", "\"ax\": "), "\"ax_g\": ", "\"ay\": ")); // other axes
            else if (of_sensor(line, 3)) lines.push_back(with(line, "\"ax\": ", "\"gx_is\": ")); // a vector with a part missing
            else lines.push_back(line);
        }
        lines.push_back(lines.back());
        const Followed f;
        const auto test = f.follow(lines);
        REQUIRE(test->follow_to(0.01));
        const RecordedTest found = test->so_far();
        CHECK(found.refused() == 2);
        CHECK(found.ways[0].strain.empty());
        CHECK(found.ways[2].strain.empty());
        CHECK(found.ways[1].displacement == recorded().read().ways[1].displacement);
        const std::string report = test->report();
        for (const char* what : {"line 1: expected an object of JSON or names of columns, found \"garbage\"", "expected the id of a file rock_NN.txt, found 99", "found 1.5",
                                 "sensor 1: t: expected a number", "expected an id, or axial_strain", "expected numbers, found 0.5 and nan", "sensor 1: refused: frame", "sensor 3: refused: numbers"}) {
            CAPTURE(what);
            CHECK(report.find(what) != std::string::npos);
        }
    }

    TEST_CASE("a stream that falls silent has ended; who goes on from its log listens again") {
        std::vector<std::string> half(recorded().lines.begin(), recorded().lines.begin() + 80);
        Followed f;
        f.settings.patience = 0.1;
        {
            const auto test = f.follow(half);
            CHECK_FALSE(test->follow_to(0.01));
            CHECK(test->over());
            CHECK(test->report().find("nothing of the test machine came for 0.1 s after 80 lines") != std::string::npos);
        }
        f.settings.patience = 2;
        LiveTest again(f.write(recorded().lines), f.folder / "log", recorded().infos, f.settings);
        REQUIRE(again.follow_to(0.01));
        check_same(again.so_far(), recorded().read());
    }

    TEST_CASE("a run that goes on knows at each strain what it knew then, not what came later") {
        std::vector<std::string> lines;
        std::vector<std::string> late;
        for (const std::string& line : recorded().lines) {
            if (of_sensor(line, 2) && line.find("strain\": 0.001") != std::string::npos) late.push_back(line); // comes at 0.5 %
            else lines.push_back(line);
            if (line.find("\"axial_strain\": 0.005,") != std::string::npos) lines.insert(lines.end(), late.begin(), late.end());
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
        CHECK(first[2].ways[1].strain.size() == 2);
        CHECK(first[6].ways[1].strain.size() == 7);
        const auto again = f.follow(lines);
        for (int k = 1; k <= 7; ++k) {
            REQUIRE(again->follow_to(1e-3 * k));
            check_same(again->so_far(), first[static_cast<std::size_t>(k - 1)]);
        }
        CHECK(again->ages().empty()); // all from the log
    }

    TEST_CASE("one wrong strain does not pass for the end of the test") {
        std::vector<std::string> lines = recorded().lines;
        lines.insert(lines.begin() + 60, {R"({"axial_strain": 0.5, "deviatoric_stress_Pa": 1e5})", R"({"id": 1, "t": 70.5, "strain": 0.5})"});
        const Followed f;
        const auto test = f.follow(lines);
        REQUIRE(test->follow_to(0.004));
        CHECK(test->so_far().measured.back().axial_strain == about(0.004));
        (void)test->follow_to(1);
        check_same(test->so_far(), recorded().read());
        CHECK(test->report().find("the machine: expected an axial strain near") != std::string::npos);
    }

    TEST_CASE("a machine that sends per cent does not end the test") {
        std::vector<std::string> lines;
        for (int k = 0; k < 40; ++k) lines.push_back(fmt::format(R"({{"axial_strain": {}, "deviatoric_stress_Pa": {}}})", 0.01 * k, 1e3 * k)); // stages of 0.01 %
        lines.emplace_back(R"({"end": 1})");
        const Followed f;
        const auto test = f.follow(lines);
        CHECK_FALSE(test->follow_to(0.01));
        CHECK(test->so_far().measured.size() == 1); // 0
        CHECK(test->report().find("is it in per cent?") != std::string::npos);
    }

    TEST_CASE("a test goes on after an outage, once three records of the machine agree where it is") {
        std::vector<std::string> lines;
        for (const std::string& line : recorded().lines) {
            const auto at = line.find("axial_strain\": ");
            const double strain = at == std::string::npos ? 0 : std::stod(line.substr(at + 15));
            if (strain > 0.0015 && strain < 0.0055) continue; // and more than 0.2 % of strain is gone
            lines.push_back(line);
        }
        const Followed f;
        const auto test = f.follow(lines);
        REQUIRE(test->follow_to(0.008));
        const auto measured = test->so_far().measured;
        CHECK(std::ranges::count_if(measured, [](const TriaxialPoint& p) { return p.axial_strain > 0.0055 && p.axial_strain < 0.0065; }) > 0);
        CHECK(test->report().find("the machine goes on at 0.0055") != std::string::npos);
    }

    TEST_CASE("a machine that falls silent ends the test, though sensors go on") {
        Followed f;
        f.settings.patience = 0.3;
        const auto path = f.write({R"({"axial_strain": 0, "deviatoric_stress_Pa": 0})"});
        std::atomic<bool> over = false;
        std::thread sensor([&] {
            for (int k = 0; !over && k < 200; ++k) {
                std::ofstream(path, std::ios::app) << fmt::format(R"({{"id": 1, "t": {}}})", 0.01 * k) << std::endl;
                std::this_thread::sleep_for(std::chrono::milliseconds(20));
            }
        });
        LiveTest test(path, f.folder / "log", recorded().infos, f.settings);
        const Instant began = this_instant();
        CHECK_FALSE(test.follow_to(0.01));
        over = true;
        sensor.join();
        CHECK(seconds_since(began) < 2);
        CHECK(test.report().find("nothing of the test machine came for 0.3 s") != std::string::npos);
    }

    TEST_CASE("lines that came and were not taken are logged when a run stops, and a cut-off line stays one") {
        const Followed f;
        {
            const auto test = f.follow(recorded().lines);
            REQUIRE(test->follow_to(0.001));
            std::this_thread::sleep_for(std::chrono::milliseconds(300)); // all are read meanwhile
        }
        const auto again = std::make_unique<LiveTest>(f.write({}), f.folder / "log", recorded().infos, f.settings);
        (void)again->follow_to(1);
        check_same(again->so_far(), recorded().read());
    }

    TEST_CASE("a replay takes its time") {
        Followed f;
        f.settings.speed = 1000; // 180 s of rest and test
        const auto test = f.follow(recorded().lines);
        const Instant began = this_instant();
        REQUIRE(test->follow_to(0.01));
        CHECK(seconds_since(began) > 0.1);
    }
}

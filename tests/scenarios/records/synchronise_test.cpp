#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "scenarios/ensemble/live_test.hpp"
#include "scenarios/ensemble/twin.hpp"
#include "scenarios/records/quality_control_report.hpp"
#include "scenarios/stream/logged_lines.hpp"
#include "scenarios/stream/recorded_stream.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/ensemble/steady_run.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

using namespace bris;

namespace {

constexpr double cycles_per_strain = 2.5e3; // 25 in the test

/// Recordings of a steady run. The caller chooses the channels of the sensors and of the machine
/// besides strain.
struct Recorded {
    TemporaryDirectory folder;
    std::vector<SensorInfo> infos;
    RecordedTest by_strain;

    Recorded() {
        const ModelRun run = testing::steady_run();
        write_recorded_test(folder.path(), 55e3, testing::placed(record_sensors(run, {}, 1), run),
                            MeasuredCurves(run.curves));
        infos = read_sensor_infos(folder.path());
        by_strain = read({});
    }
    RecordedTest read(const QualityControlSettings& settings) const {
        return read_recorded_test(folder.path(), 55e3, infos, settings);
    }

    /// Rewrites a file without one column and with another one, whose values are `value` of the
    /// strain.
    void change(const char* file, const std::string& without, const std::string& with = "",
                auto&& value = 0) const {
        const CsvTable table = read_csv(folder / "55kPa" / file);
        std::vector<std::string> names;
        for (const std::string& name : table.names)
            if (name != without) names.push_back(name);
        if (!with.empty()) names.push_back(with);
        std::vector<std::vector<double>> rows;
        for (std::size_t k = 0; k < table.rows.size(); ++k) {
            auto& row = rows.emplace_back();
            for (std::size_t c = 0; c < table.names.size(); ++c)
                if (table.names[c] != without) row.push_back(table.rows[k][c]);
            if constexpr (requires { value(0.0); })
                if (!with.empty())
                    row.push_back(value(table.column(
                        std::string(file) == "test.csv" ? "axial_strain" : "strain")[k]));
        }
        write_csv(folder / "55kPa" / file, names, rows);
    }
    void give_machine(const std::string& name, auto&& value) const {
        change("test.csv", "", name, value);
    }
};

double phase_at(double strain) { return cycles_per_strain * strain; }
double time_at(double strain) { return 60 + 1.2e4 * strain; }

void check_trajectories(const RecordedTest& test, const RecordedTest& by_strain, double tolerance) {
    CHECK(test.refused() == 0);
    for (std::size_t s = 0; s < 3; ++s) {
        REQUIRE(test.trajectories[s].strain.size() == by_strain.trajectories[s].strain.size());
        for (std::size_t k = 0; k < test.trajectories[s].strain.size(); ++k)
            CHECK(test.trajectories[s].strain[k] ==
                  about(by_strain.trajectories[s].strain[k]).epsilon(tolerance));
        CHECK(test.trajectories[s].displacement == by_strain.trajectories[s].displacement);
    }
}

bool says(const RecordedTest& test, const std::string& text) {
    INFO(quality_control_report(test));
    return quality_control_report(test).find(text) != std::string::npos;
}

} // namespace

TEST_SUITE("records/synchronise") {
    TEST_CASE("recordings with load cycles instead of strain give the same trajectories") {
        const Recorded r;
        r.give_machine("phase", phase_at);
        r.change("recordings.csv", "strain", "phase", phase_at);
        const RecordedTest test =
            r.read({.interval = 0.99e-3}); // rounding to seven digits may fall below 1e-3
        check_trajectories(test, r.by_strain, 1e-5);
        CHECK(says(test,
                   "sensors 1 to 3: clock: strain is interpolated from phase of the machine\n"));
    }

    TEST_CASE("recordings without strain or phase are synchronised by their clock minus its "
              "offset, if the machine has a clock") {
        const Recorded r;
        r.give_machine("t", time_at);
        r.change("recordings.csv", "strain", "", 0);
        RecordedTest test = r.read({.interval = 0.99e-3});
        CHECK(test.refused() == 0);
        CHECK(says(test, "sensors 1 to 3: clock: strain is interpolated from t of the machine"));
        REQUIRE(test.trajectories[0].strain.size() ==
                9); // the last sample is, by a clock 20 ppm fast, after the machine's last
        CHECK(says(test, "1 of 15 samples are outside it and left out"));
        CHECK(test.trajectories[0].strain[8] == about(9e-3).epsilon(1e-3));
        auto infos = r.infos;
        infos[1].clock_offset = 1e6; // as if it counted from 1970
        test = read_recorded_test(r.folder.path(), 55e3, infos, {});
        CHECK(test.refused() == 1);
        CHECK(says(test, "sensor 2: refused: clock: expected records of the test, 60 to 180 s by "
                         "the machine, found"));
        CHECK(says(test, "give clock_offset"));
        infos[1].clock_offset = 0;
        infos[1].clock_offset_deviation = 10;
        test = read_recorded_test(r.folder.path(), 55e3, infos, {});
        CHECK(says(test, "sensor 2: refused: clock: clock_offset is known to 30 s, during which "
                         "the axial strain grows by 0.25 %, expected at most 0.1 %"));
    }

    TEST_CASE("a clock that is ahead of the machine's by one interval is set back by its offset") {
        const Recorded r;
        r.give_machine("t", time_at);
        r.change("recordings.csv", "strain", "", 0);
        auto infos = r.infos;
        for (SensorInfo& info : infos) info.clock_offset = 12.02; // s; a sample every 12 s
        const RecordedTest test =
            read_recorded_test(r.folder.path(), 55e3, infos, {.interval = 0.99e-3});
        CHECK(test.refused() == 0);
        for (std::size_t s = 0; s < 3; ++s) {
            const SensorTrajectory &found = test.trajectories[s],
                                   &expected = r.by_strain.trajectories[s];
            REQUIRE(found.strain.size() == 9);
            for (std::size_t k = 0; k < 9; ++k) {
                CHECK(found.strain[k] == about(expected.strain[k]).epsilon(2e-3));
                // the first sample of the test is now the last one before it
                const Vec3 since = expected.displacement[k + 1] - expected.displacement[0];
                CHECK((found.displacement[k] - since).norm() < 1e-12);
            }
        }
    }

    TEST_CASE("recordings without strain, phase or a clock of the machine are refused with the "
              "reason, and the test continues without them") {
        const Recorded r;
        r.change("recordings.csv", "strain", "", 0);
        RecordedTest test = r.read({});
        CHECK(test.refused() == 3);
        CHECK(says(test,
                   "sensors 1 to 3: refused: clock: expected strain or phase in its records, or t "
                   "in those of the machine, found none\n"));
        CHECK(test.curves.size() == 101);
        const Recorded other;
        other.change("recordings.csv", "strain", "phase", phase_at);
        CHECK(says(other.read({}),
                   "expected strain in its records, or phase or t in those of the machine, found "
                   "none\n"));
    }

    TEST_CASE(
        "a phase that restarts with each cycle is refused, for a sensor and for the machine") {
        const Recorded r;
        r.give_machine("phase", phase_at);
        r.change("recordings.csv", "strain", "phase",
                 [](double strain) { return std::fmod(0.9 * phase_at(strain), 1.0); });
        const RecordedTest test = r.read({});
        CHECK(test.refused() == 3);
        CHECK(says(test, "sensors 1 to 3: refused: clock: expected phases that increase over all "
                         "cycles, found"));
        const Recorded other;
        other.give_machine("phase", [](double strain) { return std::fmod(phase_at(strain), 1.0); });
        CHECK_THROWS_WITH_AS(
            (void)other.read({}),
            doctest::Contains("test.csv:6: phase: expected increasing numbers, found 0 after 0.75"),
            InputError);
    }

    TEST_CASE("samples without a phase do not count as samples outside the test") {
        const Recorded r;
        r.give_machine("phase", phase_at);
        r.change("recordings.csv", "strain", "phase", [](double strain) {
            return std::lround(1e3 * strain) % 2 == 1 ? std::nan("") : phase_at(strain);
        });
        RecordedTest test = r.read({.interval = 0.99e-3});
        CHECK(test.refused() == 0);
        CHECK(says(test,
                   "sensors 1 to 3: clock: strain is interpolated from phase of the machine\n"));
        const auto sampled = std::ranges::count_if(test.recordings[0].strain,
                                                   [](double e) { return std::isfinite(e); });
        CHECK(sampled < static_cast<std::ptrdiff_t>(test.recordings[0].size()));
        CHECK(test.trajectories[0].strain.size() ==
              static_cast<std::size_t>(std::ranges::count_if(test.recordings[0].strain,
                                                             [](double e) { return e > 0; })));
        const Recorded late;
        late.give_machine("phase", phase_at);
        late.change("recordings.csv", "strain", "phase", [k = 0](double strain) mutable {
            return k++ < 3 ? std::nan("") : 1000 + phase_at(strain);
        });
        CHECK(says(late.read({}),
                   "sensors 1 to 3: refused: clock: expected records of the test, 0 to 25 "
                   "cycles by the machine, found 1000 to 1025\n"));
    }

    TEST_CASE("a folder is replayed as a stream with the clock and the phase of the machine") {
        const Recorded r;
        r.give_machine("t", time_at);
        r.give_machine("phase", phase_at);
        const auto lines = stream_of(r.folder / "55kPa", 1e6, 0);
        std::ofstream out(r.folder / "lines");
        std::size_t records = 0;
        for (const std::string& line : lines) {
            out << line << '\n';
            if (line.find("axial_strain") == std::string::npos) continue;
            const auto record = RecordParser().parse({1, line, {}, true});
            CHECK(record->number("t") == about(time_at(record->number("axial_strain"))));
            CHECK(record->has("phase"));
            ++records;
        }
        out.close();
        CHECK(records == 101);
        LiveTest test(open_lines(r.folder / "lines"), r.infos, {.timeout = 2});
        (void)test.follow_to(1);
        INFO(test.report());
        CHECK(test.report().find("unreadable") == std::string::npos);
        CHECK(test.so_far().curves.size() == 101);
        check_trajectories(test.so_far(), r.by_strain, 1e-9);
    }

    TEST_CASE("a stream with load cycles instead of strain gives the same test as one with "
              "strain") {
        const Recorded r;
        const auto lines = stream_of(r.folder / "55kPa", 1.2, 60);
        const auto follow = [&](const char* name, auto&& change) {
            std::ofstream out(r.folder / name);
            for (std::string line : lines) {
                change(line);
                out << line << '\n';
            }
            out.close();
            LiveTest test(open_lines(r.folder / name), r.infos,
                          {.timeout = 2, .quality_control = {.interval = 0.99e-3}});
            (void)test.follow_to(1);
            return std::pair{test.so_far(), test.report()};
        };
        const auto number_after = [](const std::string& line, const std::string& name) {
            return std::stod(line.substr(line.find(name) + name.size()));
        };
        const auto rename = [&](std::string& line, const std::string& name, auto&& phase) {
            const auto at = line.find(name);
            if (at == std::string::npos) return;
            const double strain = number_after(line, name);
            line = fmt::format("{}\"phase\": {}, {}", line.substr(0, at), phase(strain),
                               name == "\"strain\": " ? "\"was\": " + line.substr(at + name.size())
                                                      : line.substr(at));
        };
        const auto [by_phase, report] = follow("phases", [&](std::string& line) {
            rename(line, "\"strain\": ", phase_at);
            rename(line, "\"axial_strain\": ", phase_at);
        });
        INFO(report);
        check_trajectories(by_phase, r.by_strain, 1e-5);
        const auto [wrapped, why] = follow("wrapped", [&](std::string& line) {
            rename(line, "\"strain\": ", [](double strain) {
                return std::fmod(0.9 * phase_at(strain), 1.0);
            });
            rename(line, "\"axial_strain\": ", phase_at);
        });
        CHECK(wrapped.refused() == 3);
        CHECK(why.find("expected phases that increase over all cycles") != std::string::npos);
    }
}

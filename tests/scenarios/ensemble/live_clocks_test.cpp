#include "scenarios/ensemble/live_test.hpp"
#include "scenarios/ensemble/twin.hpp"
#include "scenarios/stream/recorded_stream.hpp"
#include "tests/about.hpp"
#include "tests/given_lines.hpp"
#include "tests/scenarios/ensemble/logged.hpp"
#include "tests/scenarios/ensemble/steady_run.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <fstream>
#include <functional>
#include <limits>

using namespace bris;

namespace {

constexpr double middle = 120; // s, in the test, which goes on from 60 to 180 s
constexpr int disturbed = 2;   // the id of the sensor whose records are changed
constexpr auto clock_32_bits_of_us = 4294.967296, clock_16_bits_of_ms = 65.536; // s, periods

using StreamLine = Lines::Line;

std::deque<StreamLine> deque_of(const std::vector<StreamLine>& lines) {
    return {lines.begin(), lines.end()};
}

double number_in(const std::string& line, const std::string& name) {
    const auto at = line.find("\"" + name + "\": ");
    return at == std::string::npos ? std::numeric_limits<double>::quiet_NaN()
                                   : std::stod(line.substr(at + name.size() + 4));
}

std::string with_number(const std::string& line, const std::string& name, double number) {
    const auto at = line.find("\"" + name + "\": ") + name.size() + 4;
    return fmt::format("{}{:.10g}{}", line.substr(0, at), number,
                       line.substr(line.find_first_of(",}", at)));
}

std::string without(std::string line, const std::string& name) {
    if (const auto at = line.find("\"" + name + "\": "); at != std::string::npos)
        line.erase(at, line.find(", ", at) + 2 - at);
    return line;
}

/// A test of three sensors that send a record every 1.2 s, by clocks that begin at 0.
struct SteadyStream {
    TemporaryDirectory folder;
    std::vector<SensorInfo> infos;
    std::vector<std::string> lines;

    SteadyStream() {
        const ModelRun run = testing::steady_run();
        write_recorded_test(folder.path(), 55e3,
                            testing::placed(record_sensors(run, {.interval = 1e-4}, 1), run),
                            MeasuredCurves(run.curves));
        infos = read_sensor_infos(folder.path());
        lines = stream_of(folder / "55kPa", 1.2, 60);
    }
};

const SteadyStream& steady_stream() {
    static const SteadyStream one;
    return one;
}

/// What is done to the records of one sensor, and what a test makes of it.
struct Disturbance {
    bool strain = true, arrives = true; ///< whether records carry strain, and times of arrival
    double begin = 0;                   ///< s, by the sensor's clock at the start
    /// The number that is sent instead of a t, or of a seq.
    std::function<double(double t)> clock = [](double t) { return t; };
    std::function<double(double seq)> count = [](double seq) { return seq; };

    std::vector<StreamLine> lines() const;
    std::unique_ptr<LiveTest> test() const { return test(lines()); }
    std::unique_ptr<LiveTest> test(std::vector<StreamLine> lines) const;
};

std::vector<StreamLine> Disturbance::lines() const {
    constexpr double epoch = 1.7e9, delay = 0.3; // s
    std::vector<StreamLine> all;
    double arrival = epoch;
    for (std::string line : steady_stream().lines) {
        const double t = number_in(line, "t"), id = number_in(line, "id");
        if (!strain && std::isfinite(id)) line = without(line, "strain");
        if (id == disturbed) {
            line = with_number(line, "seq", count(number_in(line, "seq")));
            line = with_number(line, "t", clock(t + begin));
        }
        if (std::isfinite(t)) arrival = std::max(arrival, epoch + t + delay);
        all.push_back({all.size() + 1, line, this_instant(), true, arrives ? arrival : no_arrival});
    }
    return all;
}

std::unique_ptr<LiveTest> Disturbance::test(std::vector<StreamLine> lines) const {
    auto infos = steady_stream().infos;
    for (SensorInfo& info : infos)
        if (info.id == disturbed) info.clock_offset = begin;
    auto test = std::make_unique<LiveTest>(
        std::make_unique<testing::GivenLines>(deque_of(lines)), std::move(infos),
        LiveSettings{.timeout = 2, .quality_control = {.interval = 5e-5}});
    for (int k = 0; k <= 100; k += 10) (void)test->follow_to(1e-4 * k);
    (void)test->follow_to(1);
    return test;
}

/// Checks that a test is that of the same stream without the disturbance, at all of its samples or
/// up to those that were left out.
void check_undisturbed(const Disturbance& d, const LiveTest& test, std::size_t left_out = 0) {
    const auto expected = Disturbance{.strain = d.strain, .arrives = d.arrives}.test()->so_far(),
               found = test.so_far();
    INFO(test.report());
    REQUIRE(expected.refused() == 0);
    CHECK(found.refused() == 0);
    for (std::size_t s = 0; s < 3; ++s) {
        const SensorTrajectory &a = found.trajectories[s], &b = expected.trajectories[s];
        CAPTURE(s);
        REQUIRE(b.strain.size() >= 99);
        REQUIRE(a.strain.size() + (s == disturbed - 1 ? left_out : 0) == b.strain.size());
        bool is_same = true;
        for (std::size_t k = 0; k < a.strain.size(); ++k)
            is_same = is_same && std::abs(a.strain[k] - b.strain[k]) < (d.strain ? 1e-15 : 2e-6) &&
                      a.displacement[k] == b.displacement[k];
        CHECK(is_same);
    }
}

bool says(const LiveTest& test, const std::string& text) {
    return test.report().find(text) != std::string::npos;
}

} // namespace

TEST_SUITE("ensemble/live_test") {
    TEST_CASE("counts of 8 and 16 bits wrap, and counts begin again: the test is the same") {
        for (const bool arrives : {true, false}) {
            const Disturbance wraps[] = {
                {.arrives = arrives, .count = [](double n) { return std::fmod(n + 200, 256); }},
                {.arrives = arrives, .count = [](double n) { return std::fmod(n + 65500, 65536); }},
                {.arrives = arrives, .count = [](double n) { return n < 90 ? n : n - 90; }}};
            for (const Disturbance& d : wraps) {
                const auto test = d.test();
                check_undisturbed(d, *test);
                CHECK(says(*test, &d == &wraps[2] ? "its counts began again 1 times"
                                                  : "its counts wrapped 1 times"));
                const auto counts = test->so_far().recordings[disturbed - 1].sequence;
                REQUIRE(counts.size() > 140);
                for (std::size_t k = 1; k < counts.size(); ++k)
                    CHECK(counts[k] == counts[k - 1] + 1);
            }
        }
    }

    TEST_CASE("a clock that begins again in the test goes on at the same strain, or else by the "
              "arrival of its records") {
        for (const bool strain : {true, false})
            for (const bool arrives : {true, false}) {
                if (!strain && !arrives) continue;
                const Disturbance d{.strain = strain, .arrives = arrives, .clock = [](double t) {
                                        return t < middle ? t : t - middle;
                                    }};
                CAPTURE(strain);
                CAPTURE(arrives);
                const auto test = d.test();
                check_undisturbed(d, *test);
                CHECK(says(*test, "its clock was set or began again 1 times"));
                const Recording r = test->so_far().recordings[disturbed - 1];
                for (std::size_t k = 1; k < r.size(); ++k) {
                    CHECK(r.time[k] - r.time[k - 1] == about(1.2).epsilon(0.05));
                    CHECK(r.sequence[k] == r.sequence[k - 1] + 1);
                }
            }
    }

    TEST_CASE("a clock that is set by an hour in the test, forward or back, changes nothing") {
        for (const double set : {3600.0, -3600.0})
            for (const bool strain : {true, false})
                for (const bool arrives : {true, false}) {
                    if (!strain && !arrives) continue;
                    const Disturbance d{
                        .strain = strain,
                        .arrives = arrives,
                        .begin = 1e4,
                        .clock = [set](double t) { return t < 1e4 + middle ? t : t + set; }};
                    CAPTURE(set);
                    CAPTURE(strain);
                    CAPTURE(arrives);
                    check_undisturbed(d, *d.test());
                }
    }

    TEST_CASE("a clock that is set back by an hour and forward again by as much changes nothing") {
        for (const bool strain : {true, false}) {
            const Disturbance d{.strain = strain, .begin = 1e4, .clock = [](double t) {
                                    return t < 1e4 + 90 || t > 1e4 + 140 ? t : t - 3600;
                                }};
            check_undisturbed(d, *d.test());
        }
    }

    TEST_CASE("a clock of 16 bits of ms or 32 bits of us wraps in the test: the test is the same") {
        for (const double period : {clock_16_bits_of_ms, clock_32_bits_of_us})
            for (const bool strain : {true, false})
                for (const bool arrives : {true, false}) {
                    const Disturbance d{
                        .strain = strain,
                        .arrives = arrives,
                        .begin = std::max(0.0, period - 100),
                        .clock = [period](double t) { return std::fmod(t, period); }};
                    CAPTURE(period);
                    CAPTURE(strain);
                    CAPTURE(arrives);
                    const auto test = d.test();
                    check_undisturbed(d, *test);
                    CHECK(says(*test, period < 100 ? "its clock wrapped 2 times"
                                                   : "its clock wrapped 1 times"));
                }
    }

    TEST_CASE("a first record that is a year ahead is left out and counted, and no other") {
        for (const bool strain : {true, false})
            for (const bool arrives : {true, false}) {
                const Disturbance d{.strain = strain, .arrives = arrives, .clock = [](double t) {
                                        return t < 2 ? t + 3.15e7 : t;
                                    }};
                const auto test = d.test();
                check_undisturbed(d, *test);
                CHECK(
                    says(*test, "1 record of an impossible time: line 2: sensor 2: t = 31500001"));
            }
    }

    TEST_CASE("without strain and without arrivals nothing tells when a clock was set: the records "
              "after that are left out as of unknown time, and a finding says so") {
        for (const double set : {-middle, -3600.0, 3600.0}) {
            const Disturbance d{.strain = false,
                                .arrives = false,
                                .begin = 0,
                                .clock = [set](double t) { return t < middle ? t : t + set; }};
            CAPTURE(set);
            const auto test = d.test();
            check_undisturbed(d, *test, 50);
            CHECK(says(*test, "51 records of unknown time: sensor 2: t = "));
            CHECK(says(*test, "sensor 2: clock: expected strain in its records, or steady times of "
                              "arrival, from when its clock was set or began again, found neither: "
                              "51 records of unknown time are left out"));
        }
    }

    TEST_CASE("a sensor of which only records of unknown time are left in the test is refused "
              "because of its clock") {
        const Disturbance d{.strain = false, .arrives = false, .clock = [](double t) {
                                return t < 50 ? t : t + 1e6;
                            }};
        const auto test = d.test();
        CHECK(test->so_far().refused() == 1);
        CHECK(test->so_far().trajectories[disturbed - 1].strain.empty());
        CHECK(says(*test, "sensor 2: refused: clock: expected strain in its records"));
    }

    TEST_CASE("other numbers at a time that was sent before are left out and counted, and copies "
              "are, however old they are") {
        const Disturbance d;
        auto lines = d.lines();
        std::vector<StreamLine> of_sensor;
        for (const StreamLine& line : lines)
            if (number_in(line.text, "id") == disturbed) of_sensor.push_back(line);
        StreamLine other = of_sensor[80];
        other.text = with_number(other.text, "ax", 3);
        other.arrival = lines.back().arrival;
        lines.insert(lines.end() - 1, {other, of_sensor[3], of_sensor[100]});
        lines[lines.size() - 2].arrival = lines[lines.size() - 3].arrival = other.arrival;
        const auto test = d.test(lines);
        check_undisturbed(d, *test);
        CHECK(says(*test, "1 record with other numbers at a time that was recorded before: line "));
        CHECK(says(*test, "2 records sent again: line "));
        CHECK(says(*test, "late, 2 sent again"));
    }

    TEST_CASE("records that come late are used, also where their times are irregular") {
        for (const char* dropped : {"nothing", "strain", "seq"}) {
            CAPTURE(dropped);
            const Disturbance d{.strain = dropped != std::string("strain"),
                                .clock = [](double t) { return t + 0.4 * std::sin(7.3 * t); }};
            auto ordered = d.lines();
            if (dropped == std::string("seq"))
                for (StreamLine& line : ordered) line.text = without(line.text, "seq");
            auto lines = ordered;
            std::vector<std::size_t> places;
            for (std::size_t k = 0; k < lines.size(); ++k)
                if (number_in(lines[k].text, "id") == disturbed) places.push_back(k);
            std::swap(lines[places[0]].text, lines[places[1]].text); // the first ones, too
            for (std::size_t k = 60; k + 7 < places.size(); k += 7)
                std::swap(lines[places[k]].text, lines[places[k + 2]].text);
            const auto expected = d.test(ordered)->so_far(), found = d.test(lines)->so_far();
            CHECK(found.refused() == 0);
            CHECK(found.recordings[disturbed - 1].time == expected.recordings[disturbed - 1].time);
            CHECK(found.trajectories[disturbed - 1].displacement ==
                  expected.trajectories[disturbed - 1].displacement);
        }
    }

    TEST_CASE("a clock that begins again near the period of another clock has not wrapped, as its "
              "arrivals tell") {
        // it is off for 36 s; a clock of 16 bits of ms would have wrapped within 15 s
        const Disturbance undisturbed{.strain = false, .begin = -47},
            d{.strain = false, .begin = -47, .clock = [](double t) { return t < 53 ? t : t - 87; }};
        const auto recording_of = [](const Disturbance& one) {
            auto lines = one.lines();
            std::erase_if(lines, [](const StreamLine& line) {
                const double t = line.arrival - 1.7e9;
                return number_in(line.text, "id") == disturbed &&
                       (t < 48.5 || (t > 99.5 && t < 136));
            });
            return one.test(lines)->so_far().recordings[disturbed - 1];
        };
        const Recording found = recording_of(d), expected = recording_of(undisturbed);
        REQUIRE(expected.size() > 75);
        REQUIRE(found.size() == expected.size());
        for (std::size_t k = 0; k < found.size(); ++k) {
            CHECK(std::abs(found.time[k] - expected.time[k]) < 0.02);
            CHECK(std::abs(found.strain[k] - expected.strain[k]) < 2e-6);
        }
    }

    TEST_CASE("a sensor whose records are too far apart for its sampling rate is refused with both "
              "numbers") {
        auto infos = steady_stream().infos;
        for (SensorInfo& info : infos)
            if (info.id == disturbed) info.sampling_rate = 1000;
        Disturbance d;
        auto lines = d.lines();
        std::size_t place = 0;
        std::erase_if(lines, [&](const StreamLine& line) {
            return number_in(line.text, "id") == disturbed && ++place % 10 != 0;
        });
        LiveTest test(std::make_unique<testing::GivenLines>(deque_of(lines)), infos,
                      {.timeout = 2});
        (void)test.follow_to(1);
        CHECK(test.so_far().refused() == 1);
        CHECK(says(test, "sensor 2: refused: clock: expected records whose times follow each "
                         "other, at 1000 samples a second (sampling_rate), found none"));
    }

    TEST_CASE("a test with a clock that begins again is the same from its log, at every strain") {
        TemporaryDirectory folder;
        const Disturbance d{.strain = false,
                            .clock = [](double t) { return t < middle ? t : t - middle; }};
        const auto read = [&](std::unique_ptr<Lines> lines) {
            std::vector<std::vector<double>> strains;
            LiveTest test(std::move(lines), steady_stream().infos, {.timeout = 2});
            for (int k = 0; k <= 20; ++k) {
                (void)test.follow_to(5e-4 * k);
                strains.push_back(test.so_far().recordings[disturbed - 1].strain);
            }
            return std::pair{strains, test.report()};
        };
        const auto live = read(std::make_unique<LoggedLines>(
            std::make_unique<testing::GivenLines>(deque_of(d.lines())),
            std::make_shared<StreamLog>(folder / "log", LoggedRecords::lines,
                                        std::uint64_t{1} << 30)));
        const auto again = read(open_lines(folder / "log"));
        CHECK(live.first == again.first);
        CHECK(live.second == again.second);
        CHECK(live.first.back().size() > 140);
    }
}

TEST_SUITE("ensemble/sensor_records") {
    TEST_CASE("segments of a clock are placed by strain, else by arrival, else not at all, and do "
              "not overlap") {
        SegmentEvidence first{.first = 0, .last = 100}, second{.first = 0, .last = 50};
        using Shifts = std::vector<std::optional<double>>;
        CHECK(shifts_of({first}, 7, 5) == Shifts{0});
        CHECK(shifts_of({first, second}, 7, 5) == Shifts{0, std::nullopt});
        first.offset_at_last = 1000;
        second.offset_at_first = 1120;
        CHECK(shifts_of({first, second}, 7, 5) == Shifts{0, 120});
        second.offset_at_first = 1097; // it overlaps by 3 s
        CHECK(*shifts_of({first, second}, 7, 5)[1] == about(100.01));
        second.offset_at_first = 1090; // by more than can be
        CHECK(shifts_of({first, second}, 7, 5) == Shifts{0, std::nullopt});
        first.offset_at_last = SegmentEvidence::unknown;
        second.by_strain = 130 - 7;
        CHECK(shifts_of({first, second}, 7, 5) == Shifts{-130, 0}); // where the first has no strain
        first.by_strain = -7;
        CHECK(shifts_of({first, second}, 7, 5) == Shifts{0, 130});
        second.by_strain = {};
        second.stands = true; // but in the time of the first
        CHECK(shifts_of({first, second}, 7, 5) == Shifts{0, std::nullopt});
    }
}

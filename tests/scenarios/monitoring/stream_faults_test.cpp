// Streams with faults of clocks, counters and deliveries, by three ways: where a fault loses
// nothing, the verdict is that of the stream without it, and never is one greener.
#include "tests/scenarios/monitoring/faulty_stream.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

using namespace bris;
using namespace bris::testing;

namespace {

enum class Expected { same, less, not_enough_data, time_unknown };

struct Fault {
    std::string name;
    /// What is to come of it by arrival, and from a file; of `n` sensors.
    std::function<Expected(unsigned n, bool has_arrival)> expected;
    std::function<void(std::vector<Sent>&)> apply;
};

constexpr double interval = 7200; // s between trains
constexpr double middle = 16;     // s after the beginning of a block: in the train

std::vector<Sent> in_order_of_arrival(std::vector<Sent> samples) {
    std::ranges::stable_sort(samples, {}, &Sent::arrival);
    return samples;
}

/// The clock of the first `wrong` sensors is `by` ahead from the middle of the second block on.
void set_clocks(std::vector<Sent>& samples, unsigned wrong, double by) {
    for (Sent& s : samples)
        if (s.sensor <= wrong && s.true_time >= interval + 2) s.t += by;
}

/// The first sensor begins again: time and count.
void restart_first(std::vector<Sent>& samples, double at) {
    const auto is_after = [&](const Sent& s) { return s.sensor == 1 && s.true_time >= at; };
    const std::uint64_t seq = std::ranges::find_if(samples, is_after)->seq;
    for (Sent& s : samples)
        if (is_after(s)) {
            s.t -= at - 1;
            s.seq -= seq;
        }
}

Expected always_same(unsigned, bool) { return Expected::same; }

/// A clock that is set can be told by its arrivals, or by most of the other sensors.
Expected by_most(unsigned n, bool has_arrival, unsigned wrong) {
    return has_arrival || 2 * wrong < n ? Expected::same : Expected::time_unknown;
}

const std::vector<Fault>& faults() {
    static const std::vector<Fault> all{
        {"clocks since boot", always_same,
         [](auto& samples) {
             for (Sent& s : samples) s.t += 12345.25;
         }},
        {"each clock since its own boot",
         [](unsigned n, bool has_arrival) {
             return has_arrival || n == 1 ? Expected::same : Expected::time_unknown;
         },
         [](auto& samples) {
             for (Sent& s : samples) s.t += 50000.0 * s.sensor;
         }},
        {"counts of 16 bits that wrap", always_same,
         [](auto& samples) {
             for (Sent& s : samples) s.seq = (s.seq + 63000) % 65536;
         }},
        {"a clock of 32 bits of us that wraps", always_same,
         [](auto& samples) {
             for (Sent& s : samples) s.t = std::fmod(s.t + 4290, 4294.967296);
         }},
        {"a restart", [](unsigned n, bool has_arrival) { return by_most(n, has_arrival, 1); },
         [](auto& samples) { restart_first(samples, interval + 2); }},
        {"one clock set back by 1 h",
         [](unsigned n, bool has_arrival) { return by_most(n, has_arrival, 1); },
         [](auto& samples) {
             for (Sent& s : samples)
                 if (s.sensor == 1 && s.true_time >= interval + 2) s.t -= 3600 + interval;
         }},
        // nothing says how long it took
        {"a restart in a train",
         [](unsigned n, bool has_arrival) {
             return has_arrival || n > 1 ? Expected::less : Expected::time_unknown;
         },
         [](auto& samples) { restart_first(samples, middle - 4); }},
        {"one clock a year ahead",
         [](unsigned n, bool has_arrival) {
             return n == 1 ? Expected::same : by_most(n, has_arrival, 1);
         },
         [](auto& samples) { set_clocks(samples, 1, 3.15e7); }},
        {"the first record wrong", always_same,
         [](auto& samples) {
             Sent wrong = samples.front();
             wrong.t = 1e9;
             wrong.arrival -= 0.1;
             samples.insert(samples.begin(), wrong);
         }},
        {"records of an impossible time in between", always_same,
         [](auto& samples) {
             for (std::size_t k = 500; k < samples.size(); k += 1501) {
                 Sent wrong = samples[k];
                 wrong.t += k % 2 == 0 ? 1e9 : -1e6;
                 samples.insert(samples.begin() + static_cast<std::ptrdiff_t>(k), wrong);
             }
         }},
        {"the clocks of two sensors wrong",
         [](unsigned n, bool has_arrival) {
             return n == 1 ? Expected::same : by_most(n, has_arrival, 2);
         },
         [](auto& samples) {
             for (Sent& s : samples)
                 if (s.sensor <= 2) s.t += 1e6 * s.sensor;
         }},
        {"the clocks of half of the sensors wrong",
         [](unsigned n, bool has_arrival) {
             return has_arrival || n == 1 ? Expected::same : Expected::time_unknown;
         },
         [](auto& samples) {
             for (Sent& s : samples)
                 if (s.sensor % 2 == 1) s.t += 1e6;
         }},
        {"retained records of last year", always_same,
         [](auto& samples) {
             Sent old = samples.front();
             old.t -= 3.15e7;
             old.retained = true;
             samples.insert(samples.begin(), old);
         }},
        {"every record twice", always_same,
         [](auto& samples) {
             std::vector<Sent> again = samples;
             for (Sent& s : again) s.arrival += 0.35;
             samples.insert(samples.end(), again.begin(), again.end());
             samples = in_order_of_arrival(samples);
         }},
        {"records in another order", always_same,
         [](auto& samples) {
             Random random(5, 1);
             double later = 0;
             for (std::size_t k = 0; k < samples.size(); ++k) {
                 if (k % 40 == 0) later = 0.7 * random.uniform();
                 samples[k].arrival += later;
             }
             samples = in_order_of_arrival(samples);
         }},
        {"half of the records lost", [](unsigned, bool) { return Expected::not_enough_data; },
         [](auto& samples) {
             std::erase_if(samples, [](const Sent& s) { return (s.seq / 40) % 2 == 1; });
         }},
        {"one train sent two hours later", [](unsigned, bool) { return Expected::same; },
         [](auto& samples) {
             for (Sent& s : samples)
                 if (s.sensor == 1 && s.true_time > middle - 4 && s.true_time < 1000)
                     s.arrival = 7100 + 0.01 * (s.true_time - middle);
             samples = in_order_of_arrival(samples);
         }},
        {"bursts of 10 s", always_same,
         [](auto& samples) {
             for (Sent& s : samples) s.arrival = 10 * std::ceil(s.true_time / 10) + 0.3;
             samples = in_order_of_arrival(samples);
         }},
        {"clocks that drift by 50 ppm", always_same,
         [](auto& samples) {
             for (Sent& s : samples) s.t *= 1 + (s.sensor % 2 == 0 ? 50e-6 : -50e-6);
         }},
    };
    return all;
}

std::string line_of(const DayResult& r) {
    std::string text =
        fmt::format("{} clear, {} changed, {} not enough, {} unknown, {} passages\n", r.all_clear,
                    r.changed, r.not_enough_data, r.time_unknown, r.passages.size());
    for (const std::string& p : r.passages) text += "  " + p + "\n";
    return text + r.report;
}

void check_all(unsigned sensors) {
    const TrainDay day = make_day(sensors, 2, interval, 3);
    for (const Way way : {Way::broker, Way::pipe, Way::file}) {
        const DayResult good = follow(day, day.samples, way);
        INFO("way ", static_cast<int>(way), ", ", sensors, " sensors\n", line_of(good));
        REQUIRE(good.passages.size() == 2);
        REQUIRE(good.all_clear == 2 * sensors);
        CHECK(good.counts.waiting == 0);
        for (const Fault& fault : faults()) {
            std::vector<Sent> samples = day.samples;
            fault.apply(samples);
            const DayResult found = follow(day, samples, way);
            CAPTURE(fault.name);
            CAPTURE(line_of(found));
            CHECK(found.counts.waiting == 0);
            CHECK(found.counts.received ==
                  found.counts.in_passages + found.counts.quiet + found.counts.left_out);
            CHECK(found.all_clear <= good.all_clear); // never greener
            switch (fault.expected(sensors, way != Way::file)) {
            case Expected::same:
                CHECK(found.passages == good.passages);
                break;
            case Expected::less:
                CHECK(found.all_clear < good.all_clear);
                CHECK(found.not_enough_data + found.time_unknown > 0);
                CHECK(found.changed == 0);
                break;
            case Expected::not_enough_data:
                CHECK(found.all_clear == 0);
                CHECK(found.not_enough_data > 0);
                break;
            case Expected::time_unknown:
                CHECK(found.time_unknown > 0);
                break;
            }
        }
    }
}

/// The monitor itself is restarted in the second train, and its clock is set meanwhile. A file is
/// read again from its beginning, and has no arrivals.
void check_restarts(unsigned sensors) {
    struct Restart {
        const char* name;
        double down_for, clock_set_by; // s
    };
    const TrainDay day = make_day(sensors, 2, interval, 3);
    for (const Way way : {Way::broker, Way::pipe}) {
        const DayResult good = follow(day, day.samples, way);
        REQUIRE(good.all_clear == 2 * sensors);
        for (const auto& [name, down_for, set_by] :
             {Restart{"monitor restarted", 60, 0},
              {"restarted and its clock set 1 h ahead", 60, 3600},
              {"restarted and its clock set 1 h back", 60, -3600},
              {"restarted and its clock set a year back", 60, -3.15e7},
              {"restarted at once", 0, 0}}) {
            const double at = interval + middle - 2;
            const RestartedDay day_found =
                follow_restarted(day, day.samples, way, {at, at + down_for}, set_by);
            const DayResult& found = day_found.found;
            INFO("way ", static_cast<int>(way), ", ", sensors, " sensors\n", line_of(good));
            CAPTURE(name);
            CAPTURE(line_of(found));
            CHECK(found.passages == good.passages);
            CHECK(found.counts.received == good.counts.received);
            CHECK(found.counts.waiting == 0);
            CHECK(day_found.replayed.given == found.given);
            CHECK(day_found.replayed.report == found.report);
        }
    }
}

} // namespace

TEST_SUITE("monitoring/stream_faults") {
    TEST_CASE(
        "a monitor that is restarted, with its clock set meanwhile, gives the verdicts of one "
        "that goes on, and its log gives them again to the bit: 1 and 4 sensors") {
        check_restarts(1);
        check_restarts(4);
    }

    TEST_CASE("trains that follow each other within an hour are judged with all sensors, in files "
              "too, whose sensors do not stop at the same record") {
        const TrainDay day = make_day(4, 3, 1500, 3);
        for (const Way way : {Way::broker, Way::file}) {
            const DayResult found = follow(day, day.samples, way);
            CAPTURE(line_of(found));
            CHECK(found.passages.size() == 3);
            CHECK(found.all_clear == 12);
            CHECK(found.counts.left_out == 0);
        }
    }

    TEST_CASE("a fault that loses nothing changes no verdict, and none makes one greener: 1 and 4 "
              "sensors, three ways") {
        check_all(1);
        check_all(4);
    }
}

TEST_SUITE("slow") {
    TEST_CASE("faults of streams of 2 and 10 sensors") {
        check_restarts(2);
        check_restarts(10);
        check_all(2);
        check_all(10);
    }
}

#include "scenarios/stream/clock.hpp"
#include "scenarios/stream/counter.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

using namespace bris;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// What a clock made of readings.
struct Sorted {
    std::size_t kept = 0, left_out = 0, held = 0;
    std::vector<double> times; ///< unwrapped, of what was kept
};

Sorted sort(SensorClock& clock, const std::vector<SensorClock::Reading>& readings) {
    Sorted s;
    std::map<std::uint64_t, std::vector<double>> held;
    for (const SensorClock::Reading& r : readings) {
        const SensorClock::Decision d = clock.take(r);
        if (d.held != SensorClock::Action::hold) {
            (d.held == SensorClock::Action::keep ? s.kept : s.left_out) += held[d.chain].size();
            if (d.held == SensorClock::Action::keep)
                for (const double t : held[d.chain]) s.times.push_back(t + d.turns);
            held.erase(d.chain);
        }
        if (d.forgotten != 0) {
            s.left_out += held[d.forgotten].size();
            held.erase(d.forgotten);
        }
        if (d.record == SensorClock::Action::hold)
            held[d.chain].push_back(r.t);
        else if (d.record == SensorClock::Action::leave_out)
            ++s.left_out;
        else {
            ++s.kept;
            s.times.push_back(r.t + d.turns);
        }
    }
    for (const auto& [chain, times] : held) s.held += times.size();
    return s;
}

/// Readings every 0.1 s; the clock leads by `lead`, and records take 0.3 s.
std::vector<SensorClock::Reading> steady(double from, double to, double lead, bool arrives = true) {
    std::vector<SensorClock::Reading> all;
    for (int k = 0; k < static_cast<int>((to - from) / 0.1 + 0.5); ++k) {
        const double time = from + 0.1 * k;
        all.push_back({time + lead, arrives ? time + 0.3 : nan, nan,
                       static_cast<std::uint64_t>(1000 * time) + 1});
    }
    return all;
}

void append(std::vector<SensorClock::Reading>& all, const std::vector<SensorClock::Reading>& more) {
    all.insert(all.end(), more.begin(), more.end());
}

} // namespace

TEST_SUITE("stream/clock") {
    TEST_CASE("the offset is the lower envelope of arrival less own time, confirmed after 10 s") {
        SensorClock clock(10);
        auto readings = steady(100, 130, -40);
        for (std::size_t k = 0; k < readings.size(); k += 3) readings[k].arrival += 5; // bursts
        CHECK(sort(clock, readings).kept == 300);
        REQUIRE(clock.current()->confirmed);
        CHECK(clock.current()->offset_at(90) == doctest::Approx(40.3).epsilon(1e-4));
    }

    TEST_CASE("records that were stored and come in a burst confirm nothing") {
        SensorClock clock(10);
        auto readings = steady(0, 60, 0);
        for (std::size_t k = 0; k < readings.size(); ++k)
            readings[k].arrival = 5000 + 1e-3 * static_cast<double>(k);
        CHECK(sort(clock, readings).kept == 600);
        CHECK_FALSE(clock.current()->confirmed);
    }

    TEST_CASE("one record of an impossible time, first or later, changes nothing") {
        for (const std::size_t at : {std::size_t{0}, std::size_t{1}, std::size_t{50}})
            for (const double wrong : {1e9, -1e9, 3600.0, -3600.0})
                for (const bool arrives : {true, false}) {
                    SensorClock clock(10);
                    auto readings = steady(100, 130, 0, arrives);
                    SensorClock::Reading bad = readings[at];
                    bad.t += wrong;
                    bad.content = 7;
                    // copies of one record are one record
                    readings.insert(readings.begin() + static_cast<std::ptrdiff_t>(at), 5, bad);
                    const Sorted s = sort(clock, readings);
                    CAPTURE(at);
                    CAPTURE(wrong);
                    CAPTURE(arrives);
                    CHECK(s.kept == 300);
                    CHECK(s.left_out + s.held == 5);
                    CHECK(clock.restarts() == 0);
                }
    }

    TEST_CASE("a clock of 32 bits of us wraps, and its unwrapped times go on") {
        SensorClock clock(10);
        auto readings = steady(4280, 4310, 0);
        for (auto& r : readings) r.t = std::fmod(r.t, 4294.967296);
        const Sorted s = sort(clock, readings);
        CHECK(s.kept == 300);
        CHECK(clock.wraps() == 1);
        for (std::size_t k = 1; k < s.times.size(); ++k)
            CHECK(s.times[k] - s.times[k - 1] == doctest::Approx(0.1));
    }

    TEST_CASE("a restart, and a clock that is set back or ahead, begin a segment with an offset of "
              "its own") {
        for (const double set : {-100.0, -3600.0, 3.15e7}) {
            SensorClock clock(10);
            auto readings = steady(100, 160, 0);
            append(readings, steady(160, 200, set));
            const Sorted s = sort(clock, readings);
            CAPTURE(set);
            CHECK(s.kept == 1000);
            CHECK(clock.restarts() == 1);
            CHECK(clock.current()->number == 1);
            CHECK(clock.current()->offset_at(190 + set) == doctest::Approx(0.3 - set));
        }
    }

    TEST_CASE("records that are sent an hour later fill their gap") {
        SensorClock clock(10);
        auto readings = steady(100, 130, 0), late = steady(130, 150, 0);
        append(readings, steady(150, 400, 0));
        for (std::size_t k = 0; k < late.size(); ++k)
            late[k].arrival = 4000 + 1e-3 * static_cast<double>(k);
        append(readings, late);
        Sorted s = sort(clock, readings);
        std::ranges::sort(s.times);
        for (std::size_t k = 1; k < s.times.size(); ++k)
            if (s.times[k] - s.times[k - 1] > 0.15) MESSAGE(s.times[k]);
        CHECK(s.kept == 3000);
        CHECK(clock.restarts() == 0);
        CHECK(clock.current()->covered.size() == 1);
        CHECK(clock.current()->offset_at(140) == doctest::Approx(0.3).epsilon(0.05));
    }

    TEST_CASE("a minute of records that is sent again is left out") {
        SensorClock clock(10);
        auto readings = steady(100, 200, 0), again = steady(120, 180, 0);
        for (auto& r : again) r.arrival = 300 + 1e-3 * (r.t - 120);
        append(readings, again);
        append(readings, steady(300.2, 310.2, 0));
        const Sorted s = sort(clock, readings);
        CHECK(s.kept == 1100);
        CHECK(s.left_out + s.held == 600);
        CHECK(clock.restarts() == 0);
    }

    TEST_CASE("a second clock under the same id is left out while the first goes on") {
        SensorClock clock(10);
        const auto first = steady(100, 160, 0), second = steady(100, 160, 5000);
        std::vector<SensorClock::Reading> readings;
        for (std::size_t k = 0; k < first.size(); ++k) {
            readings.push_back(first[k]);
            readings.push_back(second[k]);
        }
        const Sorted s = sort(clock, readings);
        CHECK(s.kept == 600);
        CHECK(s.left_out + s.held == 600);
    }

    TEST_CASE("a clock may drift by 200 ppm for a week") {
        for (const double drift : {-200e-6, 200e-6}) {
            SensorClock clock(10);
            std::size_t kept = 0;
            for (int day = 0; day < 7; ++day) {
                auto readings = steady(86400.0 * day, 86400.0 * day + 30, 0);
                for (auto& r : readings) r.t *= 1 + drift;
                kept += sort(clock, readings).kept;
                const double end = 86400.0 * day + 29.9;
                CAPTURE(day);
                CHECK(std::abs(clock.current()->offset_at(end * (1 + drift)) + end * drift - 0.3) <
                      0.03);
            }
            CHECK(kept == 2100);
            CHECK(clock.restarts() == 0);
        }
    }
}

TEST_SUITE("stream/counter") {
    TEST_CASE("counts of 8, 16 and 32 bits go on through their wraps, with gaps and late records") {
        for (const int bits : {8, 16, 32}) {
            const std::uint64_t period = std::uint64_t{1} << bits;
            Counter counter(100);
            const std::uint64_t begin = period - 20;
            std::int64_t last = counter.take(begin, 0.01);
            std::int64_t expected = last;
            CAPTURE(bits);
            for (std::uint64_t k = 1; k < 60; ++k) {
                if (k == 15) continue; // it comes late
                const double elapsed = k == 16 ? 0.02 : 0.01;
                last = counter.take((begin + k) % period, elapsed);
                expected = static_cast<std::int64_t>(begin + k);
                CHECK(last == expected);
            }
            CHECK(counter.take((begin + 15) % period, -0.44) ==
                  static_cast<std::int64_t>(begin + 15));
            CHECK(counter.wraps() == 1);
            CHECK(counter.restarts() == 0);
        }
    }

    TEST_CASE("counts that begin again go on behind those before") {
        Counter counter(100);
        for (std::uint64_t k = 500; k < 600; ++k) (void)counter.take(k, 0.01);
        CHECK(counter.take(0, 0.01) == 600);
        CHECK(counter.take(1, 0.01) == 601);
        CHECK(counter.restarts() == 1);
    }
}

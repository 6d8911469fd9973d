#include "scenarios/monitoring/synthetic_vibration.hpp"
#include "scenarios/monitoring/vibration.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

namespace {

constexpr double rate = 200; // Hz

/// A tilted rock that is shaken along the vertical by 2 sin(2 pi 10 t) from 2 s on, and rotates
/// about the track by 0.01 sin(2 pi 5 t).
Recording shaken(double until) {
    Recording r;
    r.info.id = 1;
    r.info.set_pose(Vec3::Zero(), Quat(Eigen::AngleAxisd(0.8, Vec3(1, 2, 3).normalized())));
    for (int k = 0; k < until * rate; ++k) {
        const double t = k / rate, a = t < 2 ? 0 : 2 * std::sin(2 * pi * 10 * t),
                     w = 0.01 * 2 * pi * 5 * std::cos(2 * pi * 5 * t);
        r.time.push_back(t);
        r.sequence.push_back(static_cast<std::uint64_t>(k));
        r.force.push_back(r.info.attitude().conjugate() * Vec3(0, 0, 9.81 + a));
        r.rate.push_back(r.info.attitude().conjugate() * Vec3(w, 0, 0));
    }
    return r;
}

} // namespace

TEST_SUITE("monitoring/vibration") {
    TEST_CASE("the vertical acceleration of a tilted rock, and when it passes") {
        const Vibration v = vibration_of(shaken(6), VibrationQuantity::vertical, 1);
        REQUIRE(v.runs.size() == 1);
        CHECK(v.runs[0].size() == 1200);
        CHECK(v.missing < 1e-12);
        CHECK(std::abs(v.runs[0][605] - 2 * std::sin(2 * pi * 10 * 605 / rate)) < 1e-12);
        const auto part = active_ranges(v, 0.3, 0.2);
        REQUIRE(part.size() == 1);
        CHECK(part[0].begin == 400);
        CHECK(part[0].end == 1200);
        CHECK(runs_in(v, part)[0][205] == v.runs[0][605]);
        CHECK(active_ranges(v, 3, 0.2).empty());
    }

    TEST_CASE("quiet between two trains, or after one, is not compared, at any level") {
        Vibration v{.rate = rate};
        v.runs.emplace_back();
        v.begins = {0};
        v.firsts = {0};
        for (int k = 0; k < 60 * rate; ++k) { // trains from 5 to 10 s and from 40 to 50 s
            const double t = k / rate;
            const bool train = (t >= 5 && t < 10) || (t >= 40 && t < 50);
            v.runs[0].push_back((train ? 2 : 0.05) * std::sin(2 * pi * 10 * t));
        }
        for (const double level : {1.0, 0.1, 10.0}) {
            Vibration other = v;
            for (double& x : other.runs[0]) x *= level;
            const auto ranges = active_ranges(other, 0.1 * level, 0.2);
            REQUIRE(ranges.size() == 2);
            CHECK(ranges[0].begin == 1000);
            CHECK(ranges[0].end == 2000);
            CHECK(ranges[1].begin == 8000);
            CHECK(ranges[1].end == 10000);
        }
    }

    TEST_CASE("a lost sample ends a run, and is counted") {
        Recording r = shaken(6);
        for (auto* values : {&r.force, &r.rate})
            values->erase(values->begin() + 500, values->begin() + 503);
        r.time.erase(r.time.begin() + 500, r.time.begin() + 503);
        r.sequence.erase(r.sequence.begin() + 500, r.sequence.begin() + 503);
        const Vibration v = vibration_of(r, VibrationQuantity::vertical, 1);
        REQUIRE(v.runs.size() == 2);
        CHECK(v.runs[0].size() == 500);
        CHECK(v.begins[1] == doctest::Approx(503 / rate));
        CHECK(v.missing == doctest::Approx(3.0 / 1199));
    }

    TEST_CASE("a roll about the track is found as roll rate") {
        const Vibration v = vibration_of(shaken(6), VibrationQuantity::roll_rate, 1);
        CHECK(v.rms == doctest::Approx(0.01 * 2 * pi * 5 / std::sqrt(2.0)).epsilon(1e-3));
    }

    TEST_CASE("saturated samples are counted, and a missing channel is named") {
        Recording r = shaken(6);
        r.info.force_range = 9.5;
        CHECK(vibration_of(r, VibrationQuantity::vertical, 1).saturated > 0.05);
        r.force.clear();
        CHECK(vibration_of(r, VibrationQuantity::vertical, 1).impossible_because.find("ax ay az") !=
              std::string::npos);
        CHECK(vibration_of(Recording{}, VibrationQuantity::vertical, 1).impossible_because ==
              "no samples");
    }
}

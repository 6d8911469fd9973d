// A stretch of track that settles by the law alone: what follows from it in closed form, and what a
// small model outside of this code found with the same numbers.

#include "engine/signal/median.hpp"
#include "scenarios/track/settling_track.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace bris;
using namespace bris::testing;

namespace {

/// Without scatter, with heavy axles.
SettlingTrack track_with(unsigned mud_ties, double ratio) {
    return {.stretch = {.mud_ties = mud_ties, .axle_load = 316e3},
            .law = {.ratio = ratio, .scatter = 0}};
}

StretchState settled(const SettlingTrack& track, double by, std::uint64_t number = 1) {
    return settle_track(track, {by}, number).front();
}

} // namespace

TEST_SUITE("track/settling_track") {
    TEST_CASE("an even track settles as one, without voids and dips") {
        const StretchState s = settled(track_with(0, 4), 3e-3);
        for (std::size_t i = 0; i < s.loads.size(); ++i) {
            CHECK(s.settlements[i] == about(3e-3).epsilon(1e-4));
            CHECK(s.voids[i] == 0);
            CHECK(s.loads[i] == about(1).epsilon(1e-4));
        }
        CHECK(std::abs(dip_over_chord(s.profile, 0.61, 10)) < 1e-7);
        // mud that settles as good ballast does is good ballast
        CHECK(settled(track_with(3, 1), 3e-3).settlements == s.settlements);
    }

    TEST_CASE(
        "a bad tie sinks until it settles no faster than the others: it carries r^(-1/m) of an "
        "even track's load, and less and less is missing of it") {
        const SettlingTrack track = track_with(1, 4);
        const std::size_t middle = track.stretch.ties / 2;
        const double steady = std::pow(4, -1 / 2.5); // 0.574
        const auto states = settle_track(track, {2e-3, 10e-3, 50e-3}, 1);
        double before = 1;
        for (const StretchState& s : states) {
            CHECK(s.loads[middle] < before);
            CHECK(s.loads[middle] > steady);
            CHECK(s.loads[middle + 1] > 1);
            before = s.loads[middle];
        }
        // the trough widens slowly, but not where all beyond the next ties stay level
        SettlingTrack narrow = track;
        narrow.stretch.ties = 5;
        const StretchState last = settled(narrow, 0.1);
        CHECK(last.loads[2] == about(steady).epsilon(0.002));
        CHECK(last.loads[1] == about(1).epsilon(0.002));
        // a small model outside of this code: 0.61 after some millimetres, a void of 1.4 mm
        CHECK(states[1].loads[middle] == about(0.61).epsilon(0.02));
        CHECK(states[0].voids[middle] == about(1.4e-3).epsilon(0.02));
    }

    TEST_CASE("three ties of mud that settle four times as much hang by millimetres, and their "
              "neighbours carry a fifth more") {
        // 1.4, 1.9 and 2.5 mm after 1, 2 and 4 mm; the mud tie carries 0.7, the first good one 1.2
        const SettlingTrack track = track_with(3, 4);
        const auto states = settle_track(track, {1e-3, 2e-3, 4e-3}, 1);
        const std::size_t middle = track.stretch.ties / 2;
        for (const StretchState& s : states)
            MESSAGE("void ", 1e3 * s.voids[middle], " mm, loads ", s.loads[middle], " and ",
                    s.loads[middle - 2]);
        CHECK(states[0].voids[middle] == about(1.4e-3).epsilon(0.15));
        CHECK(states[1].voids[middle] == about(1.9e-3).epsilon(0.15));
        CHECK(states[2].voids[middle] == about(2.5e-3).epsilon(0.15));
        CHECK(states[2].loads[middle] == about(0.7).epsilon(0.1));
        CHECK(states[2].loads[middle - 2] == about(1.2).epsilon(0.1));
        // by symmetry
        CHECK(states[2].loads[middle - 2] == about(states[2].loads[middle + 2]).epsilon(1e-9));
        // a ratio of 1.42 opens 0 to 0.2 mm
        CHECK(settled(track_with(3, 1.42), 4e-3).voids[middle] < 0.3e-3);
    }

    TEST_CASE("after tamping voids open as on a new track, since the mud is still there") {
        SettlingTrack track = track_with(3, 4);
        const std::size_t middle = track.stretch.ties / 2;
        const double new_track = settled(track, 1e-3).voids[middle];
        track.tamping = 2e-3;
        const auto states = settle_track(track, {2e-3, 2.0001e-3, 3e-3, 5e-3}, 1);
        CHECK(states[0].voids[middle] > 1.2 * new_track);
        CHECK(states[1].voids[middle] < 0.01 * new_track);
        CHECK(states[2].voids[middle] == about(new_track).epsilon(0.01));
        CHECK(states[3].voids[middle] == about(new_track).epsilon(0.01));
    }

    TEST_CASE("half the block changes voids by less than 2 %") {
        SettlingTrack track = track_with(3, 4), fine = track;
        fine.block = track.block / 2;
        const StretchState s = settled(track, 2e-3), half = settled(fine, 2e-3);
        const double most = std::ranges::max(s.voids);
        for (std::size_t i = 0; i < s.voids.size(); ++i)
            CHECK(std::abs(s.voids[i] - half.voids[i]) < 0.02 * most);
    }

    TEST_CASE("without mud the scatter of settlement alone makes more than half of the ties hang") {
        SettlingTrack track = track_with(0, 1);
        track.law.scatter = 0.5;
        double hanging = 0, ties = 0;
        std::vector<double> voids;
        for (std::uint64_t number = 0; number < 10; ++number) {
            const StretchState s = settled(track, 4e-3, number);
            for (const double v : s.voids) {
                ++ties;
                if (v > 0) {
                    ++hanging;
                    voids.push_back(v);
                }
            }
        }
        const double share = hanging / ties;
        MESSAGE(share, " hang, median ", 1e3 * median(voids), " mm");
        CHECK(hanging / ties > 0.4);
        CHECK(hanging / ties < 0.7);
        CHECK(settled(track, 1e-3, 3).settlements == settled(track, 1e-3, 3).settlements);
        CHECK(settled(track, 1e-3, 3).settlements != settled(track, 1e-3, 4).settlements);
    }

    TEST_CASE("the dip over a chord is that of a parabola") {
        constexpr double spacing = 0.5, curvature = 1e-4; // m, 1/m
        std::vector<double> profile;
        for (int k = 0; k <= 60; ++k) {
            const double x = spacing * (k - 20);
            profile.push_back(-0.5 * curvature * x * x);
        }
        CHECK(dip_over_chord(profile, spacing, 10) == about(curvature * 100 / 8));
        CHECK(std::isnan(dip_over_chord(profile, spacing, 31)));
        CHECK(refusal_of([] {
                  (void)settle_track({.stretch = {.ties = 3, .mud_ties = 5}}, {1e-3}, 1);
              }).starts_with("track: expected at most"));
    }
}

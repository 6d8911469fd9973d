// The rail on single ties against closed forms. Shares of discrete ties: exact numbers of an even
// track with a spacing of 0.61 m and E I = 1.58e7 N m2, from the difference equation of a beam on
// springs; Winkler and Zimmermann for the continuous foundation.

#include "engine/errors.hpp"
#include "engine/math.hpp"
#include "engine/random.hpp"
#include "scenarios/ballast_box/rail.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

using namespace bris;
using namespace bris::testing;

namespace {

constexpr double spacing = 0.61, bending = 1.58e7; // m, N m2

std::vector<double> places(std::size_t n, double by = spacing) {
    std::vector<double> at;
    for (std::size_t k = 0; k < n; ++k)
        at.push_back(by * (static_cast<double>(k) - 0.5 * static_cast<double>(n - 1)));
    return at;
}

TrackRail even_track(std::size_t n, double support, double weight = 0, double by = spacing) {
    return {places(n, by), std::vector<TieSupport>(n, {.stiffness = support}), bending, weight};
}

double sum_of(const std::vector<double>& numbers) {
    return std::accumulate(numbers.begin(), numbers.end(), 0.0);
}

/// Reaction of tie m to a unit load on tie 0 of an endless even track: the beam's stiffness for a
/// wave exp(i q m) along its ties, slopes eliminated, and the integral over all waves.
double endless_share(double support, int m) {
    constexpr int waves = 200'000;
    double sum = 0;
    for (int k = 0; k < waves; ++k) {
        const double q = 2 * pi * (k + 0.5) / waves, c = std::cos(q);
        const double beam = 12 * bending / std::pow(spacing, 3) * (1 - c) * (1 - c) / (2 + c);
        sum += support / (support + beam) * std::cos(q * m);
    }
    return sum / waves;
}

/// Ties of a track that is neither even nor well supported.
std::vector<TieSupport> uneven(std::size_t n, std::uint64_t number) {
    Random random(67, number);
    std::vector<TieSupport> supports;
    for (std::size_t k = 0; k < n; ++k)
        supports.push_back({.stiffness = 3e7 * std::exp(random.uniform(-1, 1)),
                            .gap = random.uniform() < 0.3 ? random.uniform(0, 2e-3) : 0});
    return supports;
}

} // namespace

TEST_SUITE("ballast_box/rail") {
    TEST_CASE("ties of an even track carry the exact shares of an axle above one of them") {
        struct Shares {
            double support, loaded, first, second;
        };
        for (const Shares& s :
             {Shares{30e6, 0.2862, 0.2231, 0.1205}, Shares{91e6, 0.3769, 0.2505, 0.0881}}) {
            TrackRail rail = even_track(41, s.support, 8e3);
            const double load = 100e3;
            const auto before = rail.under({}).reactions,
                       after = rail.under(std::vector<RailLoad>{{0, load}}).reactions;
            const auto share = [&](std::size_t k) { return (after[k] - before[k]) / load; };
            CHECK(std::abs(share(20) - s.loaded) < 1e-4);
            CHECK(std::abs(share(19) - s.first) < 1e-4);
            CHECK(std::abs(share(22) - s.second) < 1e-4);
            for (const int m : {0, 1, 2, 5})
                CHECK(std::abs(share(20 + static_cast<std::size_t>(m)) -
                               endless_share(s.support, m)) < 2e-6);
            const InfluenceLine line = rail.influence_on(20);
            for (const int m : {0, 1, 5})
                CHECK(std::abs(line(spacing * m) - share(20 + static_cast<std::size_t>(m))) <
                      1e-12);
        }
    }

    TEST_CASE("many close ties are Winkler's and Zimmermann's foundation") {
        constexpr double by = 0.05, modulus = 5e7, load = 1e5; // N/m2, N
        TrackRail rail = even_track(601, modulus * by, 5e3 * by, by);
        const double beta = std::pow(modulus / (4 * bending), 0.25);
        const auto dead = rail.under({}).at_ties,
                   all = rail.under(std::vector<RailLoad>{{0, load}}).at_ties;
        for (const std::size_t k : {std::size_t{300}, std::size_t{310}, std::size_t{340}}) {
            const double x = beta * by * (static_cast<double>(k) - 300);
            const double exact =
                load * beta / (2 * modulus) * std::exp(-x) * (std::cos(x) + std::sin(x));
            CHECK(std::abs(all[k] - dead[k] - exact) < 1e-5 * load * beta / (2 * modulus));
        }
        // moment below the load: E I times the curvature, M0 = P / (4 beta), which has a kink there
        const double curvature =
            ((all[301] - dead[301]) - 2 * (all[300] - dead[300]) + (all[299] - dead[299])) /
            (by * by);
        CHECK(-bending * curvature == about(load / (4 * beta)).epsilon(by * beta));
    }

    TEST_CASE(
        "wherever an axle stands between the ties, they carry it and the weights, and so much "
        "of it that its moment is carried too") {
        constexpr double weight = 5e3;
        for (std::uint64_t number = 0; number < 20; ++number) {
            constexpr std::size_t n = 21;
            TrackRail rail{places(n), uneven(n, number), bending, weight};
            for (const double x : {-3.05, -1.0, 0.2, 0.61, 2.9}) {
                const std::vector<RailLoad> axles{{x, 110e3}, {x + 1.8, 90e3}, {99, 1e5}};
                const auto found = rail.under(axles);
                CHECK(sum_of(found.reactions) == about(200e3 + n * weight).epsilon(1e-10));
                double moment = 0;
                for (std::size_t k = 0; k < n; ++k) moment += found.reactions[k] * places(n)[k];
                CHECK(std::abs(moment - (110e3 * x + 90e3 * (x + 1.8))) < 1e-8 * 200e3);
                CHECK(std::ranges::min(found.reactions) >= 0);
            }
        }
    }

    TEST_CASE(
        "a load on one tie deflects another as much as the same load there deflects the first") {
        constexpr std::size_t n = 21;
        auto supports = uneven(n, 3);
        for (TieSupport& s : supports) s.gap = 0;
        const TrackRail rail{places(n), supports, bending, 0};
        for (const auto& [a, b] : {std::pair{3, 12}, std::pair{10, 11}, std::pair{0, 20}}) {
            const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
            const double there = rail.influence_on(i)(places(n)[j]) / supports[i].stiffness,
                         back = rail.influence_on(j)(places(n)[i]) / supports[j].stiffness;
            CHECK(std::abs(there - back) <
                  1e-10 * rail.influence_on(i)(places(n)[i]) / supports[i].stiffness);
        }
    }

    TEST_CASE("a bad tie carries what its support and the rail leave it") {
        constexpr std::size_t n = 31, middle = 15;
        constexpr double good = 30e6, load = 158e3, weight = 8e3;
        TrackRail even = even_track(n, good, weight);
        const double of_rail = even.stiffness_without(middle);
        // by the reaction of an even track: K = k (1 - r) / r
        CHECK(of_rail == about(good * (1 - 0.28624) / 0.28624).epsilon(1e-3));
        for (const double bad : {3e6, 15e6, 90e6}) {
            std::vector<TieSupport> supports(n, {.stiffness = good});
            supports[middle].stiffness = bad;
            TrackRail rail{places(n), supports, bending, weight};
            const double before = rail.under({}).reactions[middle],
                         after = rail.under(std::vector<RailLoad>{{0, load}}).reactions[middle];
            // the rail without the tie sinks by P / K, and both share it
            CHECK(after - before == about(load * bad / (bad + of_rail)).epsilon(1e-9));
        }
        // one that has sunk by 1 mm hangs without an axle, and takes less under one
        std::vector<TieSupport> supports(n, {.stiffness = good});
        supports[middle].gap = 1e-3;
        TrackRail rail{places(n), supports, bending, weight};
        const auto dead = rail.under({}), loaded = rail.under(std::vector<RailLoad>{{0, load}});
        CHECK(dead.hanging == 1);
        CHECK(dead.reactions[middle] == 0);
        CHECK(dead.reactions[middle + 1] > weight);
        CHECK(loaded.hanging == 0);
        const double at_rest = weight / good; // of the even track
        CHECK(loaded.reactions[middle] ==
              about((load / of_rail + at_rest * (good + of_rail) / of_rail - 1e-3) * good *
                    of_rail / (good + of_rail))
                  .epsilon(1e-9));
    }

    TEST_CASE("the contacts are those that a search from any other load finds") {
        constexpr std::size_t n = 25;
        std::size_t hanging = 0;
        for (std::uint64_t number = 100; number < 140; ++number) {
            TrackRail rail{places(n), uneven(n, number), bending, 4e3},
                again{places(n), uneven(n, number), bending, 4e3};
            for (const double x : {-6.0, 5.0, 0.3})
                (void)again.under(std::vector<RailLoad>{{x, 2e5}});
            const std::vector<RailLoad> axle{{0.7, 1.2e5}};
            const auto one = rail.under(axle), other = again.under(axle);
            CHECK(one.hanging == other.hanging);
            for (std::size_t k = 0; k < n; ++k)
                CHECK(std::abs(one.reactions[k] - other.reactions[k]) < 1e-6);
            hanging += one.hanging;
        }
        CHECK(hanging > 40);
    }

    TEST_CASE("statics determine the reactions of two ties, and symmetry those of three") {
        const std::vector<double> two{0, 0.61};
        const TrackRail on_two{two, std::vector<TieSupport>(2, {.stiffness = 3e7}), 1.6e7, 0};
        for (const double load : {0.0, 0.2, 0.61})
            CHECK(std::abs(on_two.influence_on(1)(load) - load / 0.61) < 1e-9);
        const TrackRail on_three{places(3), std::vector<TieSupport>(3, {.stiffness = 3e7}), 1.6e7,
                                 0};
        // the beam bends by (1 - R_0) s^3 / (6 EI) between the middle tie and the outer ones
        const double soft = 3e7 * 0.61 * 0.61 * 0.61 / (6 * 1.6e7),
                     middle = on_three.influence_on(1)(0), outer = on_three.influence_on(0)(0);
        CHECK(on_three.influence_on(2)(0) == about(outer).epsilon(1e-9));
        CHECK(middle - outer == about(soft * (1 - middle)).epsilon(1e-9));
    }

    TEST_CASE("an impossible rail is refused") {
        CHECK(refusal_of([] {
                  (void)TrackRail{{1.0, 0.5}, {{.stiffness = 1}, {.stiffness = 1}}, 1, 0};
              }).starts_with("rail: expected two ties or more at ascending places"));
        CHECK(refusal_of([] {
                  (void)TrackRail{{0, 0.5}, {{.stiffness = 1}}, 1, 0};
              }).starts_with("rail: expected a support"));
        CHECK(refusal_of([] {
                  TrackRail rail = even_track(5, 3e7, 10);
                  (void)rail.under(std::vector<RailLoad>{{-1.22, 1e6}, {-1.22, -9e5}});
                  TrackRail light = even_track(5, 3e7, 0);
                  (void)light.under(std::vector<RailLoad>{{0, -1e5}});
              }).starts_with("rail: expected a rail that lies on two ties"));
    }
}

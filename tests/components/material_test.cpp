#include "components/material.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

using namespace bris;

TEST_SUITE("components/material") {
    TEST_CASE("two glass spheres have the stiffnesses of Hertz and Mindlin") {
        Materials m;
        m.add({.name = "glass", .density = 2800, .young_modulus = 4.8e10, .poisson_ratio = 0.2});
        const LawRow& k = m.hertz_pairs[0];
        CHECK(k.kn == about(4.8e10 / (2 * (1 - 0.04))).epsilon(1e-14));
        // 2 (1 - nu) / (2 - nu), Mindlin (1949)
        CHECK(k.ks / k.kn == about(0.8 * 2 / 1.8).epsilon(1e-14));
    }

    TEST_CASE("a normal force without tension gives the restitution of the closed form, and a "
              "calibrated dashpot restores the restitution that was asked for") {
        // Schwager and Poeschel (2007): restitution asked for, restitution without tension, damping
        // ratio that restores it
        const std::array<std::array<double, 3>, 5> rows{{{0.1, 0.25273, 1.24318},
                                                         {0.3, 0.39714, 0.49724},
                                                         {0.5, 0.55028, 0.25528},
                                                         {0.8, 0.80810, 0.07436},
                                                         {0.98, 0.98008, 0.00646}}};
        for (const auto& [asked, cut, calibrated] : rows) {
            const double ratio = damping_ratio(asked, Tension::allowed);
            CHECK(restitution_of(ratio, Tension::allowed) == about(asked).epsilon(1e-13));
            CHECK(restitution_of(ratio, Tension::cut) == about(cut).epsilon(1e-5)); // five digits
            CHECK(damping_ratio(asked, Tension::calibrated) == about(calibrated).epsilon(1e-3));
            CHECK(restitution_of(damping_ratio(asked, Tension::calibrated), Tension::calibrated) ==
                  about(asked).epsilon(1e-12));
        }
        CHECK(damping_ratio(1, Tension::calibrated) == 0);
        CHECK(damping_ratio(0, Tension::allowed) == 1);
    }

    TEST_CASE("a calibrated dashpot reaches every restitution above 0, but not 0") {
        for (const double e : {1e-2, 1e-4, 1e-8, 1e-100}) {
            const double ratio = damping_ratio(e, Tension::calibrated);
            CHECK(restitution_of(ratio, Tension::calibrated) == about(e).epsilon(1e-12));
            // exp(-2 ln(2 b) (1 + 1/(2 b^2)) + ...) = 1/(4 b^2) to O(e ln e): 4 % at 1e-2
            CHECK(ratio == about(0.5 / std::sqrt(e)).epsilon(e * (1 - std::log(e)) + 1e-12));
        }
        CHECK(std::isinf(damping_ratio(0, Tension::calibrated)));
    }

    TEST_CASE("the properties of a pair of materials replace the mixing rules in both orders of "
              "the pair, and survive a checkpoint") {
        Materials m;
        const auto ball = m.add({.name = "ball", .friction = 0.3, .restitution = 0.81});
        const auto wall = m.add({.name = "wall", .friction = 0.2, .restitution = 1});
        CHECK(m.linear_pairs[m.pair(ball, wall)].friction == 0.2);
        CHECK(m.linear_pairs[m.pair(ball, wall)].normal_ratio ==
              about(2 * damping_ratio(0.9, Tension::allowed)));
        m.policy.tension = Tension::calibrated;
        m.set_pair(ball, wall, {.friction = 0.7, .restitution = 0.4});
        CHECK(m.linear_pairs[m.pair(ball, wall)].friction == 0.7);
        CHECK(m.linear_pairs[m.pair(wall, ball)].normal_ratio ==
              about(2 * damping_ratio(0.4, Tension::calibrated)));
        CHECK(m.linear_pairs[m.pair(ball, ball)].friction == 0.3);
        Archive archive;
        m.save(archive);
        Materials other;
        other.add({.name = "ball"});
        other.add({.name = "wall"});
        other.load(archive);
        CHECK(other.policy.tension == Tension::calibrated);
        CHECK(other.linear_pairs[other.pair(wall, ball)].friction == 0.7);
        CHECK(other.linear_pairs[other.pair(ball, ball)].friction == 0.3);
    }

    TEST_CASE("coefficients that one law reads of a pair hold in both orders, and survive a "
              "checkpoint") {
        Materials m;
        const auto ball = m.add({.name = "ball"});
        const auto wall = m.add({.name = "wall"});
        Archive without;
        m.save(without);
        CHECK(without.find("materials/own") == nullptr);
        m.set_own(LawName::linear, ball, wall, {1, 2, 3});
        m.set_own(LawName::linear, wall, ball, {4, 5, 6});
        Archive archive;
        m.save(archive);
        Materials other = m;
        other.set_own(LawName::linear, ball, ball, {7});
        other.load(archive);
        for (const Materials& each : {m, other}) {
            CHECK(each.own(LawName::linear, ball, wall) == OwnCoefficients{4, 5, 6});
            CHECK(each.own(LawName::linear, wall, ball) == OwnCoefficients{4, 5, 6});
            CHECK(each.own(LawName::linear, ball, ball) == OwnCoefficients{});
            CHECK(each.own(LawName::hertz_mindlin, ball, wall) == OwnCoefficients{});
            CHECK(each.own_pairs.size() == 4);
        }
    }
}

#include "scenarios/ballast_box/load_turns.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace bris;

namespace {

constexpr RailOnTies usual{
    .bending = 1.58e7, .tie_support = 3e7, .spacing = 0.61, .tie_weight = 3790};
constexpr double dead = 800; // N

Train bogies(const std::vector<double>& centres, double wheelbase, double load) {
    Train train{.name = "bogies", .axles = {}};
    for (const double at : centres)
        for (const double side : {0.0, 1.0}) train.axles.push_back({at + side * wheelbase, load});
    return train;
}

} // namespace

TEST_SUITE("ballast_box/load_turns") {
    TEST_CASE("one axle is one load cycle with the peak of the closed form") {
        const Train axle{.name = "axle", .axles = {{0, 200e3}}};
        const auto turns = load_turns(axle, usual, dead);
        REQUIRE(turns.size() == 3);
        CHECK(cycles_of(turns) == 1);
        CHECK(turns[0] == dead);
        CHECK(turns[1] == about(dead + 200e3 * usual.influence()(0)).epsilon(1e-4));
        CHECK(turns[2] == dead);
    }

    TEST_CASE("each bogie is one load cycle, and its axles act together") {
        const auto turns = load_turns(bogies({0, 14, 28}, 1.8, 200e3), usual, dead);
        REQUIRE(cycles_of(turns) == 3);
        // midway between two axles 1.8 m apart
        const double between = dead + 2 * 200e3 * usual.influence()(0.9);
        CHECK(turns[1] > dead + 200e3 * (usual.influence()(0) + usual.influence()(1.8)));
        CHECK(turns[1] == about(between).epsilon(0.02));
        CHECK(turns[3] == about(turns[1]).epsilon(1e-3));
        CHECK(turns[2] < 0.01 * turns[1]);
    }

    TEST_CASE("axles far apart make a cycle each, and neighbouring bogies do not unload the tie") {
        CHECK(cycles_of(load_turns(bogies({0}, 6, 200e3), usual, dead)) == 2);
        const auto turns = load_turns(bogies({0, 3.9}, 1.8, 200e3), usual, dead);
        REQUIRE(cycles_of(turns) == 2);
        CHECK(turns[2] > 0.2 * turns[1]);
    }

    TEST_CASE("trains of the assets: peaks and valleys alternate, and no force is below 0") {
        // axles at least 2.1 m apart have peaks of their own; of the 22 bogies of the freight
        // train, two of the empty hopper stand on the slopes of the peaks of loaded cars
        for (const auto& [name, cycles] :
             {std::pair{"inspection", 8}, std::pair{"passenger", 28}, std::pair{"freight", 20}}) {
            const auto turns = load_turns(train_named(name), usual, dead);
            INFO(name);
            CHECK(cycles_of(turns) == static_cast<std::size_t>(cycles));
            for (std::size_t k = 1; k < turns.size(); ++k)
                CHECK((k % 2 == 1) == (turns[k] > turns[k - 1]));
            CHECK(std::ranges::min(turns) >= 0);
        }
    }

    TEST_CASE("the load goes through its extremes by half waves") {
        const LoadHistory load = load_through({1, 5, 2, 4, 1}, 0.5);
        CHECK(load.at(0) == 1);
        CHECK(load.at(0.5) == about(5));
        CHECK(load.at(0.75) == about(3.5));
        CHECK(load.at(1.0) == about(2));
        CHECK(load.at(1.5) == about(4));
        CHECK(load.at(2.0) == about(1));
        CHECK(load.at(9) == about(1));
    }
}

#include "engine/random.hpp"
#include "scenarios/ensemble/layouts.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

using namespace bris;

namespace {

std::vector<RockPose> rocks_on_a_line(std::size_t count) {
    std::vector<RockPose> rocks;
    for (std::size_t k = 0; k < count; ++k)
        rocks.push_back({Vec3(0.03 * static_cast<double>(k), 0, 0), Quat::Identity()});
    return rocks;
}

/// Rocks on a line that all move alike except for a small random part; the forecast is no motion.
struct Line {
    ModelRun truth, forecast;
    explicit Line(std::size_t count) {
        Random random(3, 1);
        truth.start = rocks_on_a_line(count);
        truth.sensors = 2;
        for (std::size_t k = 0; k < count; ++k) truth.rocks.push_back(static_cast<EntityId>(k));
        for (int stage = 0; stage <= 5; ++stage) {
            truth.curves.add_row()[quantity::axial_strain] = 1e-3 * stage;
            truth.displacement.emplace_back();
            truth.rotation.emplace_back(count, Vec3::Zero());
            for (std::size_t k = 0; k < count; ++k)
                truth.displacement.back().push_back(1e-3 * stage *
                                                    (Vec3(1, 0, 0) + 0.1 * random.direction()));
        }
        forecast = truth;
        for (auto& stage : forecast.displacement) std::ranges::fill(stage, Vec3::Zero());
    }
};

} // namespace

TEST_SUITE("ensemble/layouts") {
    TEST_CASE("the most informative rock of a line is the middle one, and the next ones are far "
              "from it") {
        const auto chosen = most_informative_rocks(
            rocks_on_a_line(21), {{0.9, 0.1}, {std::vector<double>(21, 1)}}, 0.1, 3);
        REQUIRE(chosen.size() == 3);
        CHECK(chosen[0] == 10);
        CHECK(std::abs(static_cast<int>(chosen[1]) - 10) > 4);
        CHECK(std::abs(static_cast<int>(chosen[2]) - 10) > 4);
        CHECK(std::set(chosen.begin(), chosen.end()).size() == 3);
    }

    TEST_CASE("sensors without samples leave the whole error, and more sensors leave less of it") {
        const Line line(30);
        const RockScatter scatter{{{0.9, 10}, {6, std::vector<double>(30, 1e-3)}},
                                  {{}, {6, std::vector<double>(30, 0)}}};
        const auto results = try_layouts(
            line.truth, line.forecast, scatter,
            {.sensors = {1, 10}, .intervals = {1e-3, 1.0}, .draws = 3, .position_noise = 1e-6});
        REQUIRE(results.size() ==
                10); // for each interval: placed; informed and random, of 1 and 10
        CHECK(results[0].layout == "placed");
        CHECK(results[0].sensors == 2);
        const auto& informed_1 = results[1];
        const auto& informed_10 = results[3];
        CHECK(informed_1.others_error_ratio < 0.3);
        CHECK(informed_10.others_error_ratio < informed_1.others_error_ratio);
        CHECK(informed_10.hosts_error_ratio < 0.05);
        for (std::size_t k = 5; k < 10; ++k)
            CHECK(results[k].others_error_ratio == about(1)); // the interval exceeds the test
    }
}

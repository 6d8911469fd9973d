// Deflections from recordings of rocks that move as the load of a train on a tie does.
#include "scenarios/monitoring/deflection.hpp"
#include "tests/scenarios/monitoring/passing_rock.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;
using namespace bris::testing;

namespace {

constexpr RailOnTies rails{.bending = 1.58e7, .tie_support = 3e7, .spacing = 0.61};

/// The largest displacement within a load cycle, from its beginning.
double true_deflection(const LoadHistory& load) {
    std::vector<double> height;
    for (double t = 0; t < load.times.back(); t += 1e-3)
        height.push_back(-displacement_under(load, t));
    double fall = 0, high = height.front();
    for (std::size_t k = 1; k < height.size(); ++k) {
        high = height[k] > height[k - 1] ? height[k] : high;
        fall = std::max(fall, high - height[k]);
    }
    return fall;
}

} // namespace

TEST_SUITE("monitoring/deflection") {
    TEST_CASE("deflections from recordings are right within their stated deviation") {
        double squares = 0;
        int count = 0;
        for (const auto& [train, speed] :
             {std::pair{"inspection", 20.0}, std::pair{"freight", 20.0}, std::pair{"freight", 15.0},
              std::pair{"passenger", 31.3}}) {
            const LoadHistory load = passing_load(train_named(train), speed, rails, 800);
            const double truth = true_deflection(load);
            for (const char* device : {"ideal", "smartrock-like"})
                for (std::uint64_t seed = 1; seed <= 8; ++seed) {
                    const auto found = deflection_of(recording_under(load, device, seed), load);
                    REQUIRE(found.impossible_because == "");
                    INFO(train << " " << device << " " << truth << " " << found.largest);
                    CHECK(std::abs(found.largest - truth) < 3 * found.deviation);
                    squares += std::pow((found.largest - truth) / found.deviation, 2);
                    ++count;
                }
        }
        CHECK(std::sqrt(squares / count) < 1.3);
        CHECK(std::sqrt(squares / count) > 0.3);
    }

    TEST_CASE("recordings that cannot give a deflection say why") {
        const LoadHistory load = passing_load(train_named("inspection"), 20, rails, 800);
        Recording r = recording_under(load, "ideal", 1);
        CHECK(deflection_of(r, load, 0.1).impossible_because.find("are too short") !=
              std::string::npos);
        Recording gap = r;
        for (std::size_t k = 400; k < gap.size(); ++k) gap.time[k] += 0.2;
        CHECK(deflection_of(gap, load).impossible_because.starts_with("a gap of 0.2"));
        Recording end = r;
        end.force[300] = Vec3::Constant(end.info.force_range);
        CHECK(deflection_of(end, load).impossible_because.find("at the end of the range") !=
              std::string::npos);
        r.force.clear();
        CHECK(deflection_of(r, load).impossible_because.starts_with("no acceleration"));
    }
}

// What a sensor on a tie says of its deflection and of the void below it.
#include "scenarios/monitoring/tie_fit.hpp"
#include "tests/scenarios/monitoring/passing_rock.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

namespace {

constexpr RailOnTies rails{
    .bending = 1.58e7, .tie_support = 4.8e7, .spacing = 0.61, .tie_weight = 3790};
constexpr double rails_weight = 800; // N, on a tie

/// Deflection (m, downwards) of the middle tie of a rail on discrete supports, which may lose their
/// contact, with a gap below this tie.
LoadHistory deflection_of_tie(const Train& train, double speed, double gap) {
    TrackRail rail = rails.rail(rails_weight, gap);
    const std::size_t middle = rails.ties_on_each_side();
    const double at_rest = rail.under({}).at_ties[middle];
    return history_of_passage(train, speed, rails, [&](std::span<const RailLoad> axles) {
        return rail.under(axles).at_ties[middle] - at_rest;
    });
}

TieFit fit_of(const LoadHistory& deflection, const PassingTrain& passing, std::uint64_t seed) {
    return fit_tie(
        recording_under(deflection, "smartrock-like", seed, 1, 0, 0, [](double w) { return w; }),
        passing);
}

} // namespace

TEST_SUITE("monitoring/tie_fit") {
    TEST_CASE(
        "the deflection of a tie and the void below it follow from a noisy sensor on it and a "
        "train that is known, its speed to a few per cent") {
        for (const auto& [name, speed] : {std::pair{"passenger", 31.3}, {"freight", 20.0}}) {
            const Train train = train_named(name);
            for (const double gap : {0.0, 0.7e-3, 2e-3}) {
                CAPTURE(name);
                CAPTURE(gap);
                const LoadHistory deflection = deflection_of_tie(train, speed, gap);
                const double largest = std::ranges::max(deflection.values);
                const TieFit fit =
                    fit_of(deflection, {train, 1.02 * speed, rails, rails_weight}, 5);
                REQUIRE(fit.impossible_because == "");
                CHECK(fit.speed == doctest::Approx(speed).epsilon(0.005));
                CHECK(fit.deflection.value == doctest::Approx(largest).epsilon(0.1));
                CHECK(std::abs(fit.gap.value - gap) < 0.35e-3);
                CHECK(fit.gap.low <= fit.gap.value);
                CHECK(fit.gap.value <= fit.gap.high);
            }
        }
    }

    TEST_CASE("the recording of another train, and noise, give no deflection") {
        const PassingTrain stated{train_named("freight"), 20, rails, rails_weight};
        const LoadHistory other = deflection_of_tie(train_named("passenger"), 20, 1e-3);
        CHECK(fit_of(other, stated, 1).impossible_because != "");
        LoadHistory still = deflection_of_tie(stated.train, 20, 0);
        for (double& w : still.values) w = 0;
        CHECK(fit_of(still, stated, 2).impossible_because != "");
    }

    TEST_CASE("a recording that is shorter than the train is refused") {
        const PassingTrain stated{train_named("passenger"), 31.3, rails, rails_weight};
        const LoadHistory inspection = deflection_of_tie(train_named("inspection"), 31.3, 0);
        const std::string why = fit_of(inspection, stated, 3).impossible_because;
        CHECK(why.find("too short") != std::string::npos);
    }
}

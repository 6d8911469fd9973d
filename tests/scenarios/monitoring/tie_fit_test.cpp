// What a sensor on a tie says of its deflection and of the void below it.
#include "engine/errors.hpp"
#include "scenarios/monitoring/tie_fit.hpp"
#include "scenarios/monitoring/tie_table.hpp"
#include "tests/scenarios/monitoring/passing_rock.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <cmath>

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

    TEST_CASE(
        "the table of ties has medians now and before, counts what tells nothing, and names a "
        "sensor that recorded nothing") {
        const Train train = train_named("inspection");
        const auto passage = [&](const char* name, double gap, std::uint64_t seed) {
            return Passage{
                .name = name,
                .recordings = {recording_under(deflection_of_tie(train, 15, gap), "smartrock-like",
                                               seed, 4, 0, 1, [](double w) { return w; })},
                .cause = {.numbers = {{"speed_m_s", 15.3}}}};
        };
        TieSettings settings;
        settings.sensors = {4};
        settings.train = "inspection";
        TieTable table(settings); // at 31.3 m/s, where the passage says nothing else
        for (std::uint64_t k = 1; k <= 3; ++k) table.add(passage("before", 0, k), true);
        table.add(passage("now", 1.5e-3, 9), false);
        CHECK(table.not_judged() == "");
        Passage noisy = passage("noise", 0, 10);
        for (Vec3& force : noisy.recordings.front().force) force = Vec3(0, 0, 9.81);
        table.add(noisy, false);
        CHECK(table.not_judged().find("sensor 4 in noise") != std::string::npos);
        const TemporaryDirectory folder;
        Report summary;
        table.write(folder.path(), summary);
        const auto numbers = nlohmann::json::parse(summary.json());
        CHECK(numbers["sensor_4_tie_void_mm"].get<double>() -
                  numbers["sensor_4_baseline_tie_void_mm"].get<double>() ==
              doctest::Approx(1.5).epsilon(0.3));
        CHECK(numbers["sensor_4_tie_deflection_mm"].get<double>() >
              1.15 * numbers["sensor_4_baseline_tie_deflection_mm"].get<double>());
        CHECK(numbers["sensor_4_passages_without_deflection"] == 1);
        CHECK(numbers["sensor_4_baseline_passages_without_deflection"] == 0);
        CHECK(std::filesystem::exists(folder / "ties.csv"));
        Passage silent = passage("silent", 0, 11);
        silent.recordings.clear();
        TieTable later(settings);
        later.add(passage("before", 0, 1), true);
        CHECK_NOTHROW(later.require_in_baseline());
        later.add(silent, false);
        CHECK(later.not_judged().find("no sample") != std::string::npos);
        settings.sensors = {4, 5};
        TieTable unknown(settings);
        unknown.add(passage("before", 0, 1), true);
        CHECK_THROWS_AS(unknown.require_in_baseline(), InputError);
    }

    TEST_CASE("a tie that never reaches its bed may have any void, and the fit says so") {
        const Train train = train_named("passenger");
        const LoadHistory deflection = deflection_of_tie(train, 31.3, 0.05);
        const double largest = std::ranges::max(deflection.values);
        const TieFit fit = fit_of(deflection, {train, 31.3, rails, rails_weight}, 8);
        REQUIRE(fit.impossible_because == "");
        CHECK_FALSE(fit.is_carried);
        CHECK(fit.gap.high == doctest::Approx(largest).epsilon(0.02));
        CHECK(fit.deflection.value == doctest::Approx(largest).epsilon(0.05));
        const LoadHistory carried = deflection_of_tie(train, 31.3, 0.5e-3);
        CHECK(fit_of(carried, {train, 31.3, rails, rails_weight}, 8).is_carried);
    }

    TEST_CASE("a recording with a sample that is no number, or in which nothing moves, gives no "
              "deflection") {
        const PassingTrain passing{train_named("passenger"), 31.3, rails, rails_weight};
        Recording broken =
            recording_under(deflection_of_tie(passing.train, 31.3, 0), "smartrock-like", 5, 1, 0, 0,
                            [](double w) { return w; });
        Recording stuck = broken;
        broken.force[broken.size() / 2].z() = std::nan("");
        CHECK(fit_tie(broken, passing).impossible_because != "");
        for (Vec3& force : stuck.force) force = stuck.force.front();
        for (Vec3& rate : stuck.rate) rate.setZero();
        CHECK(fit_tie(stuck, passing).impossible_because != "");
        PassingTrain slow = passing;
        slow.speed = 0.5;
        CHECK(fit_tie(broken, slow).impossible_because != "");
    }

    TEST_CASE("a recording that is shorter than the train is refused") {
        const PassingTrain stated{train_named("passenger"), 31.3, rails, rails_weight};
        const LoadHistory inspection = deflection_of_tie(train_named("inspection"), 31.3, 0);
        const std::string why = fit_of(inspection, stated, 3).impossible_because;
        CHECK(why.find("too short") != std::string::npos);
    }
}

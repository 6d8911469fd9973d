// Compliances from recordings of rocks that move as the load of a train on a tie does.
#include "scenarios/ballast_box/load_turns.hpp"
#include "scenarios/monitoring/compliance.hpp"
#include "tests/scenarios/monitoring/passing_rock.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;
using namespace bris::testing;

namespace {

constexpr RailOnTies rails{
    .bending = 1.58e7, .tie_support = 3e7, .spacing = 0.61, .tie_weight = 3790};

/// By least squares over the changes between extremes of the load, as Movement::compliance.
double true_compliance(const Train& train) {
    const auto turns = load_turns(train, rails, 800);
    double products = 0, squares = 0;
    for (std::size_t k = 1; k < turns.size(); ++k) {
        const double change = turns[k] - turns[k - 1];
        products +=
            change * (hardening_displacement(turns[k]) - hardening_displacement(turns[k - 1]));
        squares += change * change;
    }
    return products / squares;
}

LoadHistory load_of(const PassingTrain& p) {
    return passing_load(p.train, p.speed, p.rails, p.dead_load);
}

} // namespace

TEST_SUITE("monitoring/compliance") {
    TEST_CASE("compliances from recordings are right to a tenth, and the deviation says how far") {
        double squares = 0;
        int count = 0;
        for (const auto& [train, speed] :
             {std::pair{"inspection", 20.0}, std::pair{"freight", 20.0}, std::pair{"freight", 15.0},
              std::pair{"passenger", 31.3}}) {
            const PassingTrain passing{train_named(train), speed, rails, 800};
            const LoadHistory load = load_of(passing);
            const double truth = true_compliance(passing.train);
            for (const char* device : {"ideal", "smartrock-like"})
                for (std::uint64_t seed = 1; seed <= 2; ++seed) {
                    const auto found = compliance_of(recording_under(load, device, seed), passing);
                    REQUIRE(found.impossible_because == "");
                    INFO(train << " " << device << " " << truth << " " << found.value << " "
                               << found.deviation);
                    CHECK(std::abs(found.value / truth - 1) < 0.1);
                    squares += std::pow((found.value - truth) / found.deviation, 2);
                    ++count;
                }
        }
        CHECK(std::sqrt(squares / count) < 1.3);
        CHECK(std::sqrt(squares / count) > 0.3);
    }

    TEST_CASE("tilting rocks, bias and a recording that begins early do not matter") {
        const PassingTrain passing{train_named("inspection"), 20, rails, 800};
        const LoadHistory load = load_of(passing);
        const double straight = compliance_of(recording_under(load, "ideal", 1), passing).value;
        for (const auto& [tilt, early] : {std::pair{0.1, 0.0}, std::pair{0.0, 7.0}}) {
            Recording r = recording_under(load, "ideal", 1, 1, tilt, early);
            for (Vec3& f : r.force) f += Vec3(0.01, 0, 0.02);
            const auto found = compliance_of(r, passing);
            CAPTURE(tilt);
            CHECK(found.impossible_because == "");
            CHECK(found.value == doctest::Approx(straight).scale(0).epsilon(0.05));
        }
    }

    TEST_CASE("recordings that cannot give a compliance say why") {
        const PassingTrain passing{train_named("inspection"), 20, rails, 800};
        const LoadHistory load = load_of(passing);
        Recording r = recording_under(load, "smartrock-like", 1);
        CHECK(compliance_of(r, passing, 0.1).impossible_because.find("are too short") !=
              std::string::npos);
        Recording gap = r;
        for (std::size_t k = 400; k < gap.size(); ++k) gap.time[k] += 0.2;
        CHECK(compliance_of(gap, passing).impossible_because.starts_with("a gap of 0.2"));
        Recording end = r;
        end.force[300] = Vec3::Constant(end.info.force_range);
        CHECK(compliance_of(end, passing).impossible_because.find("at the end of the range") !=
              std::string::npos);
        Recording still = recording_under({.times = {0, 4}, .values = {0, 0}}, "smartrock-like", 2);
        CHECK(compliance_of(still, passing)
                  .impossible_because.starts_with("it fits the train no better than "));
        r.force.clear();
        CHECK(compliance_of(r, passing).impossible_because.starts_with("no acceleration"));
    }
}

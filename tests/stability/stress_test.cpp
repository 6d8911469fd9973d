// The stress suite (systems/stress), case by case at its quick size; at full size in the suite "slow".

#include "systems/stress/suite.hpp"

#include <doctest/doctest.h>

#include <functional>

using namespace bris;

namespace {

using Which = std::function<bool(const StressRow&)>;

bool mentions(const StressRow& row, const char* text) { return row.what.find(text) != std::string::npos || row.criterion.find(text) != std::string::npos; }

void check(const char* id, bool full, const Which& which = [](const StressRow&) { return true; }) {
    const StressRows rows = stress_case(id).run({.full = full});
    std::size_t looked_at = 0;
    for (const StressRow& row : rows) {
        if (!which(row)) continue;
        ++looked_at;
        CHECK_MESSAGE(row.pass, row.id, " ", row.what, ": expected ", row.criterion, ", found ", row.found);
    }
    CHECK(looked_at > 0);
}

// what the engine does not reach yet; see the cases below that should fail
bool is_estimate_of_bed(const StressRow& row) { return mentions(row, "the engine's estimate is"); }
bool is_overshoot(const StressRow& row) { return mentions(row, "overshoot"); }

void check_all(bool full) {
    for (const StressCase& c : stress_cases()) {
        CAPTURE(c.id);
        check(c.id.data(), full, [](const StressRow& row) { return !is_estimate_of_bed(row) && !is_overshoot(row); });
    }
}

} // namespace

TEST_SUITE("stability") {
    TEST_CASE("S1: threads, skins and the order of rows change no bit") { check("S1", false); }
    TEST_CASE("S4: analytic limits of the step are met within 2 %, and beds are stable at the engine's estimate") {
        check("S4", false, [](const StressRow& row) { return !is_estimate_of_bed(row); });
    }
    TEST_CASE("S5: what carries nothing is never in equilibrium") { check("S5", false); }
    TEST_CASE("S6: energy is booked, and friction, dashpots and rolling only take") { check("S6", false); }
    TEST_CASE("S7: the servo settles or says why not, within its speed limit") {
        check("S7", false, [](const StressRow& row) { return !is_overshoot(row); });
    }
    TEST_CASE("S8: small bodies between large ones roll as they should, light ones bear heavy ones") { check("S8", false); }
    TEST_CASE("S9: deep overlaps are refused, or relaxed without a bang") { check("S9", false); }
    TEST_CASE("S10: fast impacts are right or refused, and nothing passes through") { check("S10", false); }
    TEST_CASE("S12: nothing drifts over many steps") { check("S12", false); }
    TEST_CASE("S13: restitution and friction are those asked for") { check("S13", false); }
    TEST_CASE("S14: a scene in other units is the same scene") { check("S14", false); }
    TEST_CASE("S15: a scene that flies, is turned or stands far away is the same scene") { check("S15", false); }
    TEST_CASE("S16: momentum stays") { check("S16", false); }
    TEST_CASE("S20: absurd parameters are refused by name") { check("S20", false); }
    TEST_CASE("S22: what is not a number is caught, and the state before it goes on") { check("S22", false); }
    TEST_CASE("S25: lists made anew change no bit") { check("S25", false); }
    TEST_CASE("S27: clumps move as the rigid bodies that they stand for") { check("S27", false); }

    TEST_CASE("every case has its id once, and an unknown one is refused with the ids there are") {
        CHECK(stress_cases().size() == 17);
        for (const StressCase& c : stress_cases()) CHECK(&stress_case(c.id) == &c);
        CHECK_THROWS_WITH_AS(stress_case("S99"), doctest::Contains("expected one of S1, S4"), std::exception);
    }
}

TEST_SUITE("slow") {
    TEST_CASE("the stress suite at full size") { check_all(true); }
}

// Shortcomings, kept in sight: these begin to fail as tests when the engine has got better.
TEST_SUITE("stability") {
    TEST_CASE("S4, not yet: the engine's own estimate of the step is at least 0.6 of the limit of beds" * doctest::should_fail()) {
        check("S4", false, is_estimate_of_bed);
    }
    TEST_CASE("S7, not yet: pressures overshoot a sudden target by less than 5 %" * doctest::should_fail()) { check("S7", false, is_overshoot); }
}

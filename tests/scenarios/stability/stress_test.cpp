// The stress suite (systems/stress), case by case at its quick size; at full size in the suite
// "slow".

#include "scenarios/stability/suite.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

using namespace bris;

namespace {

bool mentions(const StressRow& row, const char* text) {
    return row.what.find(text) != std::string::npos;
}

// What the engine does not reach yet, row by row; the suite prints how far it is off.
bool is_known_shortcoming(const StressRow& row) {
    if (row.id == "S6") // grazing, or with friction above 1, at 0.1 of the critical step
        return std::ranges::any_of(std::array{"friction 0 to 1, linear: closure",
                                              "friction 3 and 10, linear: closure",
                                              "friction 0 to 1, Hertz-Mindlin: closure",
                                              "friction 0 to 1, Hertz-Mindlin, dashpots: closure",
                                              "friction 0 to 1, Hertz-Mindlin, rolling: closure"},
                                   [&](const char* text) { return mentions(row, text); });
    // walls that touch stiff grains are heavy: their last swings, up to 1 % of the pressure, die
    // away slowly
    return row.id == "S7" && (mentions(row, "stiffness 1e+08 N/m: pressure") ||
                              mentions(row, "stiffness 1e+09 N/m: pressure") ||
                              mentions(row, "stiffness 1e+10 N/m: pressure"));
}

void check(std::string_view id, bool full) {
    const StressRows rows = run_case(stress_case(id), {.full = full});
    CHECK(!rows.empty());
    for (const StressRow& row : rows) {
        const bool is_known = is_known_shortcoming(row);
        // begins to fail when the engine has become better: then the row is to be required like the
        // others
        if (is_known)
            CHECK_MESSAGE(!row.pass, row.id, " ", row.what,
                          " falls short no more: take it off the list of known shortcomings");
        else
            CHECK_MESSAGE(row.pass, row.id, " ", row.what, ": expected ", row.criterion, ", found ",
                          row.found);
    }
}

} // namespace

TEST_SUITE("stability") {
    TEST_CASE("S1: threads, skins and the order of rows change no bit") { check("S1", false); }
    TEST_CASE("S4: analytic limits of the step are met within 2 %, and beds are stable at the "
              "engine's estimate") {
        check("S4", false);
    }
    TEST_CASE("S5: what carries nothing is never in equilibrium") { check("S5", false); }
    TEST_CASE("S6: energy is booked, and friction, dashpots and rolling only take") {
        check("S6", false);
    }
    TEST_CASE("S7: the servo settles or says why not, within its speed limit") {
        check("S7", false);
    }
    TEST_CASE(
        "S8: small bodies between large ones roll as they should, light ones bear heavy ones") {
        check("S8", false);
    }
    TEST_CASE("S9: deep overlaps are refused, or relaxed without a bang") { check("S9", false); }
    TEST_CASE("S10: fast impacts are right or refused, and nothing passes through") {
        check("S10", false);
    }
    TEST_CASE("S11: what sensors say wrong is refused, and the bodies go on without it") {
        check("S11", false);
    }
    TEST_CASE("S12: nothing drifts over many steps") { check("S12", false); }
    TEST_CASE("S13: restitution and friction are those asked for") { check("S13", false); }
    TEST_CASE("S14: a scene in other units is the same scene") { check("S14", false); }
    TEST_CASE("S15: a scene that flies, is turned or stands far away is the same scene") {
        check("S15", false);
    }
    TEST_CASE("S16: momentum stays") { check("S16", false); }
    TEST_CASE("S20: absurd parameters are refused by name") { check("S20", false); }
    TEST_CASE("S22: what is not a number is caught, and the state before it goes on") {
        check("S22", false);
    }
    TEST_CASE("S25: lists made anew change no bit") { check("S25", false); }
    TEST_CASE("S27: clumps move as the rigid bodies that they stand for") { check("S27", false); }

    TEST_CASE("every case has its id once, and an unknown one is refused with the ids there are") {
        CHECK(stress_cases().size() == 18);
        for (const StressCase& c : stress_cases()) CHECK(&stress_case(c.id) == &c);
        CHECK_THROWS_WITH_AS(stress_case("S99"), doctest::Contains("expected one of S1, S4"),
                             std::exception);
    }
}

// at full size, minutes each
TEST_SUITE("slow") {
    TEST_CASE("S1 at full size") { check("S1", true); }
    TEST_CASE("S4 at full size") { check("S4", true); }
    TEST_CASE("S5 at full size") { check("S5", true); }
    TEST_CASE("S6 at full size") { check("S6", true); }
    TEST_CASE("S7 at full size") { check("S7", true); }
    TEST_CASE("S8 at full size") { check("S8", true); }
    TEST_CASE("S9 at full size") { check("S9", true); }
    TEST_CASE("S10 at full size") { check("S10", true); }
    TEST_CASE("S11 at full size") { check("S11", true); }
    TEST_CASE("S12 at full size") { check("S12", true); }
    TEST_CASE("S13 at full size") { check("S13", true); }
    TEST_CASE("S14 at full size") { check("S14", true); }
    TEST_CASE("S15 at full size") { check("S15", true); }
    TEST_CASE("S16 at full size") { check("S16", true); }
    TEST_CASE("S20 at full size") { check("S20", true); }
    TEST_CASE("S22 at full size") { check("S22", true); }
    TEST_CASE("S25 at full size") { check("S25", true); }
    TEST_CASE("S27 at full size") { check("S27", true); }
}

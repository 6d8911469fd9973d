// The stress suite (tests/stability), case by case at its quick size. The suite "slow" runs it
// at full size.

#include "tests/stability/suite.hpp"

#include <doctest/doctest.h>

#include <string_view>

using namespace bris;

namespace {

void check(std::string_view id, bool full) {
    const StressRows rows = run_case(stress_case(id), {.full = full});
    CHECK(!rows.empty());
    for (const StressRow& row : rows)
        CHECK_MESSAGE(row.pass, row.id, " ", row.what, ": expected ", row.criterion, ", found ",
                      row.found);
}

} // namespace

TEST_SUITE("stability") {
    TEST_CASE("S1: threads, skins and the order of rows do not change a bit of the results") {
        check("S1", false);
    }
    TEST_CASE("S4: analytic limits of the time step are met within 2 %, and beds are stable at the "
              "engine's estimate") {
        check("S4", false);
    }
    TEST_CASE("S5: a scene that carries no load is never in equilibrium") { check("S5", false); }
    TEST_CASE("S6: the energy budget closes, and friction, dashpots and rolling only dissipate") {
        check("S6", false);
    }
    TEST_CASE("S7: the servo settles within its speed limit or stops with a reason") {
        check("S7", false);
    }
    TEST_CASE("S8: small bodies roll correctly between large ones, and light bodies carry heavy "
              "ones") {
        check("S8", false);
    }
    TEST_CASE("S9: deep overlaps are refused, or relaxed without an explosion") {
        check("S9", false);
    }
    TEST_CASE("S10: fast impacts are computed correctly or refused, and no body passes through "
              "another") {
        check("S10", false);
    }
    TEST_CASE("S11: faulty samples of sensors are refused, and bodies move as without them") {
        check("S11", false);
    }
    TEST_CASE("S12: conserved quantities do not drift over many steps") { check("S12", false); }
    TEST_CASE("S13: restitution and friction have their nominal values") { check("S13", false); }
    TEST_CASE("S14: results do not depend on the units") { check("S14", false); }
    TEST_CASE("S15: results do not depend on motion, rotation or position of the reference frame") {
        check("S15", false);
    }
    TEST_CASE("S16: momentum and angular momentum are conserved") { check("S16", false); }
    TEST_CASE("S18: a bed settles with sleeping grains as without, and no sleeping grain floats") {
        check("S18", false);
    }
    TEST_CASE("S20: absurd parameters are refused by name") { check("S20", false); }
    TEST_CASE("S22: a NaN is detected, and the state before it can be continued") {
        check("S22", false);
    }
    TEST_CASE("S25: rebuilding neighbour lists does not change a bit of the results") {
        check("S25", false);
    }
    TEST_CASE("S27: clumps move as the rigid bodies that they represent") { check("S27", false); }

#ifndef BRIS_SANITIZED // the address sanitizer keeps what was freed for a while
    TEST_CASE("S29: scenes that are loaded and run again and again leave nothing behind") {
        check("S29", false);
    }
#endif

    TEST_CASE("every case has a unique id, and an unknown id is refused with the list of ids") {
        CHECK(stress_cases().size() == 20);
        for (const StressCase& c : stress_cases()) CHECK(&stress_case(c.id) == &c);
        CHECK_THROWS_WITH_AS(stress_case("S99"), doctest::Contains("expected one of S1, S4"),
                             std::exception);
    }
}

// each case takes minutes at full size
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
    TEST_CASE("S18 at full size") { check("S18", true); }
    TEST_CASE("S20 at full size") { check("S20", true); }
    TEST_CASE("S22 at full size") { check("S22", true); }
    TEST_CASE("S25 at full size") { check("S25", true); }
    TEST_CASE("S27 at full size") { check("S27", true); }
    TEST_CASE("S29 at full size") { check("S29", true); } // 30 minutes
}

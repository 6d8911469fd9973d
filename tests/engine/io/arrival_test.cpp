#include "engine/io/arrival.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

TEST_SUITE("engine/io/arrival") {
    TEST_CASE(
        "the arrivals of a resumed run go on as before while the computer is on, whatever the "
        "wall clock says, and never go back after that") {
        const ArrivalsBefore before{.anchor = 1000, .last = 1500, .boot = "a"};
        for (const double wall : {-3000.0, 1000.0, 4600.0}) // it was set
            CHECK(anchor_after(before, "a", 700, wall) == 1000);
        CHECK(anchor_after(before, "b", 10, 5000) == 5000);
        CHECK(anchor_after(before, "b", 10, 400) == 1490); // set back: at least 1500
        CHECK(anchor_after({}, "a", 10, 400) == 400);      // nothing arrived
        CHECK(anchor_after({.anchor = 1000}, "", 10, 400) == 400);
    }

    TEST_CASE("the anchor that a program goes on with is that of its arrivals") {
        const double anchor = arrival_anchor();
        const ArrivalsBefore before{.anchor = anchor - 5000, .last = 0, .boot = boot_of_computer()};
        if (before.boot.empty()) return;
        const double then = arrival_now();
        go_on_after(before);
        CHECK(arrival_anchor() == anchor - 5000);
        CHECK(std::abs(then - 5000 - arrival_now()) < 1);
        go_on_after({.anchor = anchor, .last = 0, .boot = boot_of_computer()});
        CHECK(arrival_anchor() == anchor);
    }
}

// Push of a short tie through a small bed.
#include "scenarios/field_tests/tie_bed.hpp"
#include "scenarios/specimens/bench.hpp"

#include <doctest/doctest.h>

using namespace bris;

namespace {

TieBed small_bed() {
    TieBed bed;
    bed.tie_length = 0.3;
    bed.tie_mass = 100;
    bed.base = 0.15;
    bed.shoulder = 0.1;
    bed.rocks.scale = 1.2;
    bed.porosity = 0.45;
    bed.displacement = 2e-3;
    bed.speed = 0.05;
    bed.interval = 1e-4;
    return bed;
}

} // namespace

TEST_SUITE("tie_push") {
    TEST_CASE("settings of a tie that do not fit together are refused by name") {
        TieBed close = small_bed();
        close.spacing = 0.3;
        CHECK(refusal_of([&] { check_tie_bed(close); }).find("--spacing") == 0);
        TieBed coarse = small_bed();
        coarse.rocks.scale = 2;
        CHECK(refusal_of([&] { (void)make_tie_bed(coarse, 1, 1, false); }).find("--spacing") == 0);
        TieBed few = small_bed();
        few.interval = 1e-3;
        CHECK(refusal_of([&] { check_tie_bed(few); }).find("--interval") == 0);
    }
}

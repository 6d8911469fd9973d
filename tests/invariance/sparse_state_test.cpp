#include "systems/broadphase/lists.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;

TEST_SUITE("invariance/sparse_state") {
    TEST_CASE("a pair without a rolling spring keeps its tangential spring through a restart") {
        const auto make = [] {
            World world = tumbling({.bodies = 30});
            // without rolling resistance the rolling springs are 0
            return begin(std::move(world), {.dt = 2e-5, .law = LawName::linear_rolling});
        };
        Simulation sim = make();
        sim.advance(8000);
        const Archive middle = sim.snapshot();
        std::size_t springs = 0;
        for (const SpringRow& s : sim.world().column<SpherePairs, Spring>())
            springs += Spring::keep(s) ? 1u : 0u;
        REQUIRE(springs > 20);
        CHECK(middle.find("sphere_pairs/spring")->rows() == springs);
        sim.advance(500);
        Simulation again = make();
        again.restore(middle);
        again.advance(500);
        CHECK(fingerprint(again.snapshot()) == fingerprint(sim.snapshot()));
    }
}

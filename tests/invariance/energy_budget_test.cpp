// The energy budget evaluates contacts that have ended once more; this must not move a body.

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "engine/archive.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "tests/edges.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>

using namespace bris;

TEST_SUITE("invariance/energy_budget") {
    TEST_CASE("bodies move to the same bits with an energy budget and without") {
        for (const LawName law :
             {LawName::linear, LawName::linear_viscous, LawName::linear_rolling,
              LawName::hertz_mindlin, LawName::hertz_mindlin_rolling, LawName::hertz_edges})
            for (const Grains grains : {Grains::spheres, Grains::clumps})
                for (const Walls walls : {Walls::planes, Walls::facets}) {
                    CAPTURE(static_cast<int>(law));
                    CAPTURE(static_cast<int>(grains));
                    CAPTURE(static_cast<int>(walls));
                    std::array<std::uint64_t, 2> positions{}, momenta{};
                    for (const bool with : {false, true}) {
                        World world = bed({.grains = grains, .walls = walls, .bodies = 25});
                        testing::add_edges(world);
                        Simulation simulation = begin(
                            std::move(world), {.dt = 2e-5, .law = law, .energy_budget = with});
                        simulation.advance(3000);
                        if (with && has_wear(law)) {
                            const auto wear = simulation.world().column<Bodies, WearWork>();
                            CHECK(*std::ranges::max_element(wear) > 0);
                        }
                        const Archive state = simulation.snapshot();
                        positions[with ? 1 : 0] = fingerprint(state, "bodies/position");
                        momenta[with ? 1 : 0] = fingerprint(state, "bodies/angular_momentum");
                    }
                    CHECK(positions[0] == positions[1]);
                    CHECK(momenta[0] == momenta[1]);
                }
    }
}

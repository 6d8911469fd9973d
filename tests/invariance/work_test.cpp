#include "scenarios/specimens/relax.hpp"
#include "scenarios/specimens/sphere_bed.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/output/quantities.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

// Amounts of work that a change must not raise unnoticed: counts, which do not depend on the load
// of the machine. A change that alters one on purpose updates the number here and gives its reason
// in the commit.

using namespace bris;

namespace {

Simulation bed_at_work() {
    SphereBed bed;
    bed.spheres = 500;
    World world = make_sphere_bed(bed);
    world.resource<Gravity>().value *= 10;
    return begin(std::move(world), {.law = LawName::linear_viscous});
}

} // namespace

TEST_SUITE("invariance/work") {
    TEST_CASE("a collapsing and settling bed needs the same numbers of lists, candidates and "
              "contacts as before") {
        Simulation sim = bed_at_work();
        sim.advance(8000);
        const ListState& lists = sim.world().resource<ListState>();
        CHECK(lists.rebuilds == 16);
        CHECK(lists.prunes == 286);
        CHECK(lists.sorts == 2);
        CHECK(sim.world().table<SpherePairs>().size() == 1277);
        CHECK(sim.world().resource<NearIndex<SpherePairs>>().size() == 1005);
        CHECK(compute_quantities(sim.world()).contacts == 1039);
    }

    TEST_CASE("deeply overlapping clumps in a box of facets separate in as many steps as before, "
              "and then settle with the same work") {
        World world =
            bed({.grains = Grains::clumps, .walls = Walls::facets, .bodies = 48, .seed = 3});
        for (Vec3& x : world.column<Bodies, Position>()) x *= 0.8; // makes them overlap
        const Relaxed relaxed = relax(world, LawName::linear_viscous);
        CHECK(relaxed.done);
        CHECK(relaxed.steps == 80);
        Simulation sim = begin(std::move(world), {.dt = 2e-5, .law = LawName::linear_viscous});
        sim.advance(4000);
        const ListState& lists = sim.world().resource<ListState>();
        CHECK(lists.rebuilds == 80);
        CHECK(lists.prunes == 261);
        CHECK(lists.sorts == 10);
        CHECK(sim.world().table<SpherePairs>().size() == 612);
        CHECK(sim.world().table<FacetPairs>().size() == 172);
        CHECK(compute_quantities(sim.world()).contacts == 76);
    }
}

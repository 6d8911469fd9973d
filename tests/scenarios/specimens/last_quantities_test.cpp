#include "engine/archive.hpp"
#include "scenarios/specimens/last_quantities.hpp"
#include "scenarios/specimens/small_scene.hpp"

#include <doctest/doctest.h>

using namespace bris;

TEST_SUITE("specimens/last_quantities") {
    TEST_CASE("a run that is resumed after its last step reports the contacts of that step") {
        const auto begin_run = [] {
            return begin(tumbling({}), {.dt = 2e-5, .law = LawName::linear_viscous});
        };
        Simulation first = begin_run();
        LastQuantities before(first);
        first.advance(5000);
        Archive checkpoint = first.snapshot();
        before.save(checkpoint);
        REQUIRE(before.quantities().contacts > 10);

        Simulation second = begin_run();
        LastQuantities after(second);
        second.restore(checkpoint);
        after.load(checkpoint);
        const Quantities a = before.quantities(), b = after.quantities();
        CHECK(b.contacts == a.contacts);
        CHECK(b.body_contacts == a.body_contacts);
        CHECK(b.coordination == a.coordination);
        CHECK(b.kinetic_energy == a.kinetic_energy);
        CHECK(b.elastic_energy == a.elastic_energy);
        CHECK(b.mean_overlap == a.mean_overlap);
        CHECK(b.largest_overlap == a.largest_overlap);
        CHECK(b.mean_normal_force == a.mean_normal_force);
        CHECK(b.unbalanced_ratio == a.unbalanced_ratio);
        CHECK(b.boundary_force == a.boundary_force);
        CHECK(b.weight == a.weight);
        CHECK(after.stable_step() == before.stable_step());

        first.advance(1000); // and a run that goes on, those of its own last step
        second.advance(1000);
        CHECK(after.quantities().kinetic_energy == before.quantities().kinetic_energy);
        CHECK(after.quantities().kinetic_energy != a.kinetic_energy);
    }
}

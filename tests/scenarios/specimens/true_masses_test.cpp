#include "scenarios/specimens/true_masses.hpp"
#include "systems/contact/mass_scaling.hpp"
#include "systems/contact/stable_step.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

TEST_SUITE("specimens/true_masses") {
    TEST_CASE("masses that were scaled and restored are the true ones, and the work of scaling and "
              "restoring adds up to zero") {
        Simulation sim = begin(bed({.grains = Grains::clumps, .bodies = 30}),
                               {.dt = 2e-5, .law = LawName::linear});
        sim.world().table<Bodies>().add<ScalingWork>();
        sim.advance(2500);
        std::vector<Vec3> momentum;
        for (EntityId b = 0; b < 30; ++b) momentum.push_back(value_of<AngularMomentum>(sim, b));
        scale_masses(sim.world(), 5e-4, 0.8, false);
        REQUIRE(std::abs(value_of<InertialMass>(sim, 0) / value_of<Mass>(sim, 0) - 1) > 0.01);
        const double one_way = value_of<ScalingWork>(sim, 0);
        REQUIRE(one_way != 0);
        const double step = restore_masses(sim.world());
        CHECK(step <= stable_step(sim.world()));
        CHECK(step > 0);
        for (EntityId b = 0; b < 30; ++b) {
            CHECK(value_of<InertialMass>(sim, b) == value_of<Mass>(sim, b));
            CHECK(value_of<InertialInertia>(sim, b) == value_of<Inertia>(sim, b));
            // a multiplication and a division of each number: a few roundings
            CHECK((value_of<AngularMomentum>(sim, b) - momentum[b]).norm() <=
                  1e-15 * 4 * momentum[b].norm());
        }
        CHECK(std::abs(value_of<ScalingWork>(sim, 0)) <= 1e-14 * std::abs(one_way));
    }
}

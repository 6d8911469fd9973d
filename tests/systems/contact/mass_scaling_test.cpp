#include "systems/contact/mass_scaling.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/output/quantities.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

namespace {

/// Kinetic energy (J) of the velocities and momenta as stored, half a step before the positions.
double kinetic(Simulation& sim) {
    double sum = 0;
    for (EntityId b = 0; b < 30; ++b)
        sum += 0.5 * value_of<InertialMass>(sim, b) * value_of<Velocity>(sim, b).squaredNorm() +
               0.5 * value_of<AngularMomentum>(sim, b).dot(value_of<AngularVelocity>(sim, b));
    return sum;
}

} // namespace

TEST_SUITE("contact/mass_scaling") {
    TEST_CASE(
        "scaled masses make the requested step stable, keep weights, and account for the energy "
        "that they add") {
        World world = bed({.grains = Grains::clumps, .bodies = 30});
        const std::vector<double> weight(world.column<Bodies, Mass>().begin(),
                                         world.column<Bodies, Mass>().end());
        Simulation sim = begin(std::move(world), {.dt = 2e-5, .law = LawName::linear});
        sim.world().table<Bodies>().add<ScalingWork>();
        sim.advance(300); // still falling
        const double before = kinetic(sim);
        REQUIRE(std::isfinite(stable_step(sim.world())));
        const double dt = 5e-4, safety = 0.8;
        const MassScaling done = scale_masses(sim.world(), dt, safety, false);
        CHECK(done.dt == dt);
        // dt is `safety` times the smallest stable step of all bodies
        CHECK(stable_step(sim.world()) >= dt / safety * (1 - 1e-12));
        for (const EntityId b : {0u, 7u, 29u}) CHECK(value_of<Mass>(sim, b) == weight[b]);
        double total = 0;
        for (EntityId b = 0; b < 30; ++b) total += value_of<InertialMass>(sim, b);
        CHECK(done.total_mass == about(total).epsilon(1e-13));
        double accumulated = 0;
        for (EntityId b = 0; b < 30; ++b) accumulated += value_of<ScalingWork>(sim, b);
        CHECK(kinetic(sim) - before == about(accumulated).epsilon(1e-9));
        CHECK(std::abs(accumulated) > 1e-9);
        // the angular velocity agrees with the new momentum
        for (const EntityId b : {0u, 7u, 29u}) {
            const Vec3 local =
                value_of<Orientation>(sim, b).conjugate() * value_of<AngularMomentum>(sim, b);
            CHECK((value_of<Orientation>(sim, b) *
                       Vec3(local.cwiseQuotient(value_of<InertialInertia>(sim, b))) -
                   value_of<AngularVelocity>(sim, b))
                      .norm() <
                  0.1 * value_of<AngularVelocity>(sim, b).norm()); // they are half a step apart
        }
    }

    TEST_CASE("without a requested step, the sum of the scaled masses is that of the true masses") {
        Simulation sim = begin(bed({.grains = Grains::clumps, .bodies = 30}),
                               {.dt = 2e-5, .law = LawName::linear});
        sim.advance(2500);
        double total = 0;
        for (EntityId b = 0; b < 30; ++b) total += value_of<Mass>(sim, b);
        const MassScaling done = scale_masses(sim.world(), 0, 0.8, false);
        CHECK(done.total_mass == about(total).epsilon(1e-12));
        CHECK(done.smallest_factor < 1);
        CHECK(done.largest_factor > 1);
    }

    TEST_CASE(
        "a rock without contacts is scaled as one with six, and one much larger than the others "
        "as one with as many more as its surface offers") {
        // thirty radii, of which the last one is `ratio` times their mean; the contacts that count
        const auto contacts = [](double ratio) {
            World world = bed({.grains = Grains::clumps, .bodies = 30});
            Simulation sim = begin(std::move(world), {.dt = 2e-5, .law = LawName::linear});
            sim.advance(1); // nothing touches yet
            const auto radius = sim.world().column<Bodies, BoundingRadius>();
            const auto motion = sim.world().column<Bodies, MotionOf>();
            Row last = 0;
            for (Row b = 0; b < radius.size(); ++b)
                if (motion[b] == static_cast<std::uint32_t>(Motion::free)) {
                    radius[b] = 1e-3;
                    last = b;
                }
            radius[last] = 1e-3 * 29 * ratio / (30 - ratio);
            (void)scale_masses(sim.world(), 1e-4, 0.9, false);
            const auto mass = sim.world().column<Bodies, InertialMass>();
            const Row other = last == 0 ? 1 : last - 1;
            return 6 * mass[last] / mass[other];
        };
        CHECK(contacts(1) == about(6).epsilon(1e-12));
        CHECK(contacts(2.9) == about(6).epsilon(1e-12));
        // the centres of its neighbours lie on a sphere of six mean radii; on one of four as usual
        CHECK(contacts(5) == about(6 * (1 + 6. * 6 / 4 - 4. * 4 / 4)).epsilon(1e-12));
    }

    TEST_CASE("dashpots follow scaled masses in the next step, so that a restored run goes on as "
              "the undisturbed one") {
        const auto falling = [] {
            return begin(bed({.grains = Grains::clumps, .bodies = 30}),
                         {.dt = 2e-5, .law = LawName::linear_viscous});
        };
        Simulation live = falling(), restored = falling();
        live.advance(2500);
        REQUIRE(compute_quantities(live.world()).contacts > 0);
        (void)scale_masses(live.world(), 5e-4, 0.4, false);
        restored.restore(live.snapshot());
        live.advance(1);
        restored.advance(1);
        CHECK(fingerprint(restored.snapshot()) == fingerprint(live.snapshot()));
    }
}

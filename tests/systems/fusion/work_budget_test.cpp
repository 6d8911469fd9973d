#include "engine/errors.hpp"
#include "scenarios/specimens/bench.hpp"
#include "systems/fusion/correct.hpp"
#include "systems/fusion/fuse.hpp"
#include "systems/fusion/spread.hpp"
#include "systems/fusion/work_budget.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

using namespace bris;

namespace {

constexpr double kn = 1e5, dt = 1e-6, share = 0.1;
constexpr unsigned steps = 20;

/// A ball with a sensor between two fixed balls, touching both: a correction along x stores kn d^2.
/// The first fixed ball represents the boundaries.
struct Squeezed {
    Simulation sim;
    Squeezed() : sim(make()) { sim.advance(2); }
    static Simulation make() {
        World world = make_world(Grains::spheres);
        const auto m = world.resource<Materials>().add(linear_material(kn, 4e4, 0));
        world.resource<Materials>().mix();
        (void)add_sphere(world, Vec3::Zero(), 0.01, m);
        for (const double x : {-0.0199, 0.0199})
            (void)add_sphere(world, Vec3(x, 0, 0), 0.01, m, Motion::fixed);
        add_sensors(world, {0}, {{}}, {}, steps);
        Simulation sim =
            begin(std::move(world),
                  {.dt = dt, .law = LawName::linear, .energy_budget = true, .unlimited = true});
        set_work_budget(sim.world(), share);
        return sim;
    }
    WorkBudget& budget() { return sim.world().resource<Fusion>().budget; }
    CorrectionRow& correction() { return value_of<Correction>(sim, 0); }
    /// The boundaries do work (J), and an analysis has a correction d (m) along x. Returns the
    /// applied part of it (m).
    double analysis(double of_boundaries, double d) {
        value_of<BoundaryWork>(sim, 1) += of_boundaries;
        Fusion& fusion = sim.world().resource<Fusion>();
        begin_analysis(sim.world());
        const std::size_t first = fusion.records.size();
        fusion.records.emplace_back();
        set_correction(correction(), value_of<Guided>(sim, 0), Vec3(d, 0, 0), Vec3::Zero(), steps);
        CHECK(energy_of_corrections(sim.world()) == about(kn * d * d));
        limit_corrections(sim.world(), first, energy_of_corrections(sim.world()));
        const CorrectionRow& c = correction();
        CHECK(std::abs(fusion.records.back().share - c.steps * c.shift.x() / d) < 1e-12);
        return c.steps * c.shift.x();
    }
};

} // namespace

TEST_SUITE("fusion/work_budget") {
    TEST_CASE("a correction that would store more than the allowed energy is reduced to it, and "
              "does that much work") {
        const double d = 2e-5, stored = kn * d * d, allowed = 0.2 * stored;
        Squeezed balls;
        CHECK(balls.analysis(allowed / share, d) == about(std::sqrt(0.2) * d));
        CHECK(balls.budget().allowed == about(allowed));
        CHECK(balls.budget().expected == about(stored));
        CHECK(balls.budget().reduced == 1);
        CHECK(balls.budget().withheld == 0);
        balls.sim.advance(steps + 1);
        // the contacts push the ball back a little meanwhile: by (omega t)^2 / 12 of d, 1 %
        CHECK(fusion_work(balls.sim.world()) == about(allowed).epsilon(0.03));
    }

    TEST_CASE("a correction that stores less is applied in full, with the bits of a world without "
              "a limit") {
        Squeezed limited, free;
        free.budget() = {};
        for (Squeezed* balls : {&limited, &free}) {
            CHECK(balls->analysis(1, 1e-5) == about(1e-5));
            balls->sim.advance(3 * steps);
            CHECK(balls->budget().reduced == 0);
        }
        CHECK(fingerprint(limited.sim.snapshot(), "bodies/") ==
              fingerprint(free.sim.snapshot(), "bodies/"));
    }

    TEST_CASE("the withheld part of a correction increases the covariance of the filter") {
        Squeezed balls;
        const double d = 2e-5;
        const auto deviation = [&] {
            return std::sqrt(balls.sim.world().resource<Fusion>().filters[0].covariance()(0, 0));
        };
        const double before = deviation(), given = balls.analysis(0.2 * kn * d * d / share, d);
        CHECK(deviation() * deviation() ==
              about(before * before + (d - given) * (d - given)).epsilon(1e-9));
    }

    TEST_CASE("a correction that would have to be reduced below a hundredth is withheld: the ball "
              "stays, and no work is done") {
        Squeezed balls;
        const double d = 2e-5;
        CHECK(balls.analysis(0.9e-4 * kn * d * d / share, d) == 0);
        CHECK(balls.budget().withheld == 1);
        CHECK(balls.budget().reduced == 0);
        const Vec3 before = value_of<Position>(balls.sim, 0);
        balls.sim.advance(steps);
        CHECK(value_of<Position>(balls.sim, 0) == before);
        CHECK(fusion_work(balls.sim.world()) == 0);
        // the next time half the cost is expected
        CHECK(balls.analysis(1.1e-4 * kn * d * d / share, d) > 0);
    }

    TEST_CASE("if corrections cost more than expected, the next are expected to cost as much, and "
              "the deficit reduces the allowed work") {
        const double d = 2e-5, stored = kn * d * d, allowance = 0.2 * stored;
        Squeezed balls;
        (void)balls.analysis(allowance / share, d);
        value_of<FusionWork>(balls.sim, 0) += 1.5 * allowance; // 1.5 times the allowance
        const double given = balls.analysis(allowance / share, d);
        CHECK(balls.budget().ratio == about(1.5));
        CHECK(balls.budget().allowed == about(0.5 * allowance));
        CHECK(given == about(d * std::sqrt(0.5 * 0.2 / 1.5)));
        // negative work, and work on another body, count as well
        value_of<FusionWork>(balls.sim, 1) -= 3 * allowance;
        CHECK(balls.analysis(allowance / share, d) == 0);
        CHECK(balls.budget().deficit == about(2.5 * allowance));
        (void)balls.analysis(2 * allowance / share, d);
        CHECK(balls.budget().deficit == about(1.5 * allowance));
    }

    TEST_CASE("nudging gets the gain that is expected to cost the allowed work, and is released "
              "once it has cost that much") {
        Squeezed balls;
        Fusion& fusion = balls.sim.world().resource<Fusion>();
        fusion.nudging = {1e4, 1, 0.01};
        NudgingRow& nudging = value_of<Nudging>(balls.sim, 0);
        const auto begin_with = [&](double of_boundaries) {
            value_of<BoundaryWork>(balls.sim, 1) += of_boundaries;
            begin_analysis(balls.sim.world());
            set_nudging(nudging, value_of<Guided>(balls.sim, 0),
                        {Vec3(1e-4, 0, 0), Vec3::Zero(), Quat::Identity(), Vec3::Zero()},
                        fusion.nudging, fusion.budget.gain);
        };
        begin_with(1);
        // the initial ratio assumes that at full gain nudging costs the work of the boundaries
        CHECK(fusion.budget.gain == about(share));
        CHECK(nudging.largest_force == about(share));
        value_of<FusionWork>(balls.sim, 0) += 0.02; // a fifth of the allowed work
        hold_nudging_forces(balls.sim.world());
        CHECK(nudging.is_active());
        CHECK(nudging.held == 1);
        begin_with(1);
        CHECK(fusion.budget.ratio == about(0.5));
        CHECK(fusion.budget.gain == about(2 * share)); // it grows by a factor of 2 at most
        CHECK(nudging.held == 0);
        value_of<FusionWork>(balls.sim, 0) += 0.11;
        hold_nudging_forces(balls.sim.world());
        CHECK_FALSE(nudging.is_active());
        balls.sim.advance(2);
        CHECK(nudging.force.norm() == 0);
        CHECK(value_of<Guided>(balls.sim, 0) == 0);
    }

    TEST_CASE("nudging that would have to be a hundred times weaker is withheld, and tried again "
              "with half the expected cost") {
        Squeezed balls;
        Fusion& fusion = balls.sim.world().resource<Fusion>();
        fusion.nudging = {1e4, 1, 0.01};
        fusion.budget.ratio = 11;
        const auto gain = [&] {
            value_of<BoundaryWork>(balls.sim, 1) += 1;
            begin_analysis(balls.sim.world());
            return fusion.budget.gain;
        };
        CHECK(gain() == 0);
        CHECK(gain() == about(share / 5.5));
    }

    TEST_CASE("the work budget survives a checkpoint") {
        Squeezed balls, resumed;
        (void)balls.analysis(1e-7 / share, 2e-5);
        balls.sim.advance(steps / 2);
        resumed.sim.restore(balls.sim.snapshot());
        for (Squeezed* b : {&balls, &resumed}) {
            b->sim.advance(2 * steps);
            (void)b->analysis(1e-7 / share, 3e-5);
            b->sim.advance(steps);
        }
        CHECK(balls.budget().ratio != 1);
        CHECK(fingerprint(balls.sim.snapshot()) == fingerprint(resumed.sim.snapshot()));
    }

    TEST_CASE("a share below 0 or above 1 is an error") {
        Squeezed balls;
        CHECK_THROWS_WITH_AS(set_work_budget(balls.sim.world(), 1.5),
                             doctest::Contains("found 1.5"), InputError);
        CHECK_THROWS_WITH_AS(set_work_budget(balls.sim.world(), -0.1),
                             doctest::Contains("found -0.1"), InputError);
    }
}

#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/ensemble/live_model.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/ensemble/simple_point.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace bris;

namespace {

/// A minimal model: q, and the displacements of a sensor rock and its neighbour, from friction and
/// stiffness; the members diverge at random, with neighbouring rocks correlated.
ModelRun simple_run(const RockParameters& rocks, double strain, std::uint64_t seed) {
    ModelRun run;
    Random random(seed, 11);
    const double push = 0.03 * random.normal();
    const Vec3 scatter = 2e-4 * random.direction();
    for (int k = 0; k <= std::lround(strain / 1e-4); ++k) {
        testing::add_simple_stage(run.curves, rocks, k * 1e-4, push);
        const double progress = k * 1e-4 / 0.02;
        run.displacement.push_back({progress * (Vec3(1e-3 * rocks.friction, 0, 0) + scatter),
                                    progress * (Vec3(1e-3 * rocks.friction, 0, 0) + 0.9 * scatter),
                                    progress * Vec3(0, 0, 1e-3)});
        run.rotation.emplace_back(3, Vec3::Zero());
    }
    run.rocks = {0, 1, 2};
    run.sensors = 1;
    run.start = {{Vec3(0.1, 0, 0), Quat::Identity()},
                 {Vec3(0.1, 0.03, 0), Quat::Identity()},
                 {Vec3(0, 0, 0.2), Quat::Identity()}};
    run.shell = {0, 1, 4};
    return run;
}

/// The records of a run up to some strain.
RecordedTest recorded(const ModelRun& run, double strain) {
    RecordedTest test;
    test.recordings.emplace_back().info.displacement_noise = 1e-6;
    test.displacement_noise = 1e-6;
    test.trajectories.emplace_back();
    for (std::size_t k = 0;
         k < run.curves.size() && run.curves[quantity::axial_strain][k] <= strain + 1e-9; ++k) {
        test.curves.add_row_of(run.curves, k);
        if (k == 0 || k % 10 != 0) continue;
        test.trajectories[0].strain.push_back(run.curves[quantity::axial_strain][k]);
        test.trajectories[0].displacement.push_back(run.displacement[k][0]);
        test.trajectories[0].rotation.push_back(Vec3::Constant(std::nan("")));
        test.trajectories[0].tilt.push_back(Vec3::Constant(std::nan("")));
    }
    return test;
}

/// Adds stages of a whole run, up to a number of points.
void grow(ModelRun& run, const ModelRun& whole, std::size_t points) {
    const std::size_t had = run.curves.size();
    if (had == 0) run = empty_run_like(whole);
    for (std::size_t k = had; k < points; ++k) {
        REQUIRE(k < whole.curves.size()); // nothing is asked for where the test does not go
        run.curves.add_row_of(whole.curves, k);
        run.displacement.push_back(whole.displacement[k]);
        run.rotation.push_back(whole.rotation[k]);
    }
}

struct Case {
    static constexpr RockParameters rocks{0.7, 1}, assumed{0.5, 1.3};
    ModelRun truth = simple_run(rocks, 0.02, 77);
    unsigned runs = 0, checkpoint = 0;
    unsigned stopping = 0;     // number of members of the second generation that a guard stops
    std::size_t stops_at = 50; // number of points at which it stops them
    std::size_t longest = 0, longest_step = 0; // most points requested, in all and at a time
    Learning learning;

    LiveModel model(double final_strain = 0.02, unsigned catch_up = 4) {
        return LiveModel(
            {assumed, learning, 1e-4, final_strain, catch_up},
            [this, final_strain](const std::vector<ModelVariant>& variants) {
                std::vector<ModelRun> whole;
                const bool second = runs > 0;
                for (const ModelVariant& variant : variants)
                    whole.push_back(simple_run(variant.rocks, final_strain, 100 + runs++));
                return ConcurrentRuns{
                    [this, second, whole](std::vector<ModelRun>& all, std::size_t points) mutable {
                        all.resize(whole.size());
                        longest = std::max(longest, points);
                        if (!all[0].curves.empty() || second)
                            longest_step = std::max(longest_step, points - all[0].curves.size());
                        for (std::size_t k = 0; k < all.size(); ++k) grow(all[k], whole[k], points);
                        for (; second && stopping > 0 && points > stops_at; --stopping) {
                            all[stopping].stopped = "a guard";
                            whole.erase(whole.begin() + stopping);
                        }
                    },
                    [this] { ++checkpoint; }};
            });
    }
};

double error(const ModelRun& run, const ModelRun& truth, std::size_t rock) {
    return (run.displacement.back()[rock] - truth.displacement[run.curves.size() - 1][rock]).norm();
}

} // namespace

TEST_SUITE("ensemble/live_model") {
    TEST_CASE(
        "the parameters are estimated stage by stage, and the observations of sensors correct "
        "their neighbours") {
        Case c;
        LiveModel model = c.model();
        CHECK(c.runs == 8); // before any record
        CHECK(c.longest == 21);
        while (!model.done()) model.next_stage(recorded(c.truth, model.next_strain()));
        CHECK(c.runs == 16);
        CHECK(model.state().curves.size() == 201);
        CHECK(model.strain() == about(0.02));
        CHECK(std::abs(mean_of(model.estimate()).friction - 0.7) < 0.05);
        CHECK(squared_distance(model.estimate(), logarithms_of({0.7, 1})) < 9.2);
        for (std::size_t k = 1; k < model.estimates().size(); ++k)
            CHECK(model.estimates()[k].strain > model.estimates()[k - 1].strain);
        CHECK(error(model.state(), c.truth, 0) < 0.05 * error(model.forecast(), c.truth, 0));
        CHECK(error(model.state(), c.truth, 1) < 0.5 * error(model.forecast(), c.truth, 1));
        CHECK(std::abs(model.state().curves[quantity::deviatoric_stress].back() /
                           c.truth.curves[quantity::deviatoric_stress].back() -
                       1) < 0.1);
    }

    TEST_CASE("later records do not change earlier stages, and without records the model continues "
              "by itself") {
        Case one, other;
        for (std::size_t k = 51; k < other.truth.curves.size(); ++k) {
            other.truth.curves[quantity::deviatoric_stress][k] *= 2;
            other.truth.displacement[k][0] *= 2;
        }
        LiveModel a = one.model(), b = other.model();
        for (int k = 0; k <= 200; ++k) {
            a.next_stage(recorded(one.truth, a.next_strain()));
            b.next_stage(recorded(other.truth, b.next_strain()));
            if (k > 50) continue;
            CHECK(a.state().curves[quantity::deviatoric_stress].back() ==
                  b.state().curves[quantity::deviatoric_stress].back());
            CHECK(a.state().displacement.back() == b.state().displacement.back());
        }
        CHECK(a.state().displacement.back() != b.state().displacement.back());
        Case silent;
        LiveModel quiet = silent.model();
        while (!quiet.done())
            quiet.next_stage(recorded(silent.truth, std::min(0.005, quiet.next_strain())));
        CHECK(quiet.state().curves.size() == 201);
        CHECK(quiet.estimates().back().strain <= 0.01);
        for (const Vec3& d : quiet.state().displacement.back()) CHECK(d.allFinite());
    }

    TEST_CASE("ensemble members do not run ahead of the stage of the test, and advance only a few "
              "stages at a time") {
        for (const unsigned catch_up : {2u, 4u, 7u}) {
            CAPTURE(catch_up);
            Case c;
            LiveModel model = c.model(0.02, catch_up);
            while (!model.done()) {
                model.next_stage(recorded(c.truth, model.next_strain()));
                CHECK(c.longest == std::max<std::size_t>(21, model.state().curves.size()));
                model.advance_members();
                CHECK(c.longest ==
                      std::clamp<std::size_t>(model.state().curves.size() + 1, 21, 201));
                CHECK(c.longest_step <= catch_up);
            }
            // 20 stages, the start, and one for each stage of the test meanwhile, at `catch_up`
            // stages for each stage of the test
            const double needed = std::ceil(21.0 / (catch_up - 1));
            CHECK(model.caught_up_at() == about((20 + needed) * 1e-4));
            CHECK(c.checkpoint == 1); // of the first generation, after its last forecast
            model.save_checkpoint();
            CHECK(c.checkpoint == 2);
        }
    }

    TEST_CASE("members advanced before the records arrive or afterwards give the same bits") {
        Case one, other;
        LiveModel a = one.model(), b = other.model();
        while (!a.done()) {
            a.next_stage(recorded(one.truth, a.next_strain()));
            for (int k = 0; k < 3; ++k) a.advance_members();
            b.next_stage(recorded(other.truth, b.next_strain()));
            CHECK(a.state().curves[quantity::deviatoric_stress].back() ==
                  b.state().curves[quantity::deviatoric_stress].back());
            CHECK(a.state().displacement.back() == b.state().displacement.back());
            CHECK(a.estimate().mean == b.estimate().mean);
        }
        CHECK(a.caught_up_at() == b.caught_up_at());
    }

    TEST_CASE("a member that a guard stops in the middle of the test is left out, and too many end "
              "the test") {
        Case c;
        c.stopping = 2;
        LiveModel model = c.model();
        while (!model.done()) model.next_stage(recorded(c.truth, model.next_strain()));
        CHECK(c.stopping == 0);
        CHECK(squared_distance(model.estimate(), logarithms_of({0.7, 1})) < 9.2);
        for (const Vec3& d : model.state().displacement.back()) CHECK(d.allFinite());
        Case lost;
        lost.stopping = 3;
        LiveModel too_few = lost.model();
        const auto to_the_end = [&] {
            while (!too_few.done()) too_few.next_stage(recorded(lost.truth, too_few.next_strain()));
        };
        CHECK_THROWS_AS(to_the_end(), SimulationError);
        CHECK(too_few.state().curves.size() == 50);
    }

    TEST_CASE("too few members left of a second generation that has not caught up do not end the "
              "test: the first generation provides the forecast to the end") {
        Case lost, early;
        lost.stops_at = early.stops_at = 10;
        lost.stopping = early.stopping = 3;
        LiveModel model = lost.model(), other = early.model();
        while (!model.done()) {
            model.next_stage(recorded(lost.truth, model.next_strain()));
            for (int k = 0; k < 3; ++k) other.advance_members(); // before the records arrive
            other.next_stage(recorded(early.truth, other.next_strain()));
            CHECK(model.state().displacement.back() == other.state().displacement.back());
            CHECK(model.estimate().mean == other.estimate().mean);
        }
        CHECK(lost.runs == 16); // no further generation begins
        CHECK(lost.stopping == 0);
        CHECK(model.caught_up_at() == 0);
        // it began with stage 20, and advances four stages for each one since
        CHECK(model.lost_second_at() == about(23e-4));
        CHECK(other.lost_second_at() == model.lost_second_at());
        CHECK(model.state().curves.size() == 201);
        CHECK(lost.checkpoint == 1); // so that a resumed run loses its members at the same stage
        CHECK(squared_distance(model.estimate(), logarithms_of({0.7, 1})) < 9.2);
        CHECK(error(model.state(), lost.truth, 0) < 0.05 * error(model.forecast(), lost.truth, 0));
    }

    TEST_CASE("a test shorter than the first generation needs no second one") {
        Case c;
        LiveModel model = c.model(1e-3);
        while (!model.done()) model.next_stage(recorded(c.truth, model.next_strain()));
        CHECK(c.runs == 8);
        CHECK(model.state().curves.size() == 11);
    }
}

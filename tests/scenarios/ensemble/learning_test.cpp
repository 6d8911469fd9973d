#include "engine/errors.hpp"
#include "engine/estimation/parameter_estimate.hpp"
#include "engine/random.hpp"
#include "scenarios/ensemble/generations.hpp"
#include "scenarios/ensemble/learning.hpp"
#include "scenarios/ensemble/twin.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/ensemble/simple_point.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>

using namespace bris;

namespace {

/// A minimal model: q and a displacement from friction and stiffness, with a random perturbation
/// that grows.
ModelRun simple_run(const RockParameters& rocks, double strain, std::uint64_t seed) {
    ModelRun run;
    Random random(seed, 11);
    const double push = 0.05 * random.normal();
    for (int k = 0; k <= std::lround(strain / 1e-4); ++k) {
        testing::add_simple_stage(run.curves, rocks, k * 1e-4, push);
        const TestCurves::Row p{run.curves, static_cast<std::size_t>(k)};
        run.displacement.push_back({Vec3(0, 0, -p[quantity::axial_strain] * (1 + rocks.friction))});
        run.rotation.push_back({Vec3::Zero()});
    }
    run.rocks = {0};
    run.start = {{Vec3(0.1, 0, 0), Quat::Identity()}};
    return run;
}

/// The same with dilation that increases with friction.
ModelRun dilating_run(const RockParameters& rocks, std::uint64_t seed) {
    ModelRun run = simple_run(rocks, 0.01, seed);
    for (std::size_t k = 0; k < run.curves.size(); ++k)
        run.curves[quantity::volumetric_strain][k] =
            -1.5 * rocks.friction * run.curves[quantity::axial_strain][k];
    return run;
}

/// The same with a sensor rock whose outward displacement increases with friction.
ModelRun widening_run(const RockParameters& rocks, std::uint64_t seed) {
    ModelRun run = simple_run(rocks, 0.01, seed);
    run.sensors = 1;
    for (std::size_t k = 0; k < run.curves.size(); ++k)
        run.displacement[k][0].x() =
            0.1 * (2 + std::log(rocks.friction)) * run.curves[quantity::axial_strain][k];
    return run;
}

} // namespace

TEST_SUITE("ensemble/learning") {
    TEST_CASE(
        "friction and stiffness are estimated from the axial force of a test, and the forecast "
        "is then right") {
        const RockParameters truth{0.7, 1}, wrong{0.5, 1.3};
        Learning learning;
        const ModelRun real = simple_run(truth, 0.02, 77);
        const Gaussian prior = prior_of(wrong, learning);
        unsigned runs = 0, longest = 0;
        const Learned learned = learn_in_two_generations(
            prior, Measurements{MeasuredCurves(real.curves)}, learning, 0.02,
            [&](const std::vector<ModelVariant>& variants, double strain) {
                std::vector<ModelRun> all;
                for (const ModelVariant& variant : variants)
                    all.push_back(simple_run(variant.rocks, strain, 100 + runs++));
                longest = std::max(longest, static_cast<unsigned>(all.front().curves.size()));
                return all;
            });
        CHECK(runs == 16);
        CHECK(longest == 201);
        const Gaussian& estimates = learned.estimates.back().estimate;
        CHECK(learned.estimates.back().strain == about(learning.final_strain));
        CHECK(std::abs(mean_of(estimates).friction - 0.7) < 0.05);
        CHECK(squared_distance(estimates, logarithms_of(truth)) < 9.2);
        CHECK(estimates.covariance()(0, 0) < 0.1 * prior.covariance()(0, 0));
        CHECK(estimates.covariance()(1, 1) < 0.25 * prior.covariance()(1, 1));
        for (std::size_t k = 1; k < learned.estimates.size(); ++k)
            CHECK(learned.estimates[k].strain > learned.estimates[k - 1].strain);
        const ModelRun together = ensemble_forecast(learned, prior),
                       without = simple_run(wrong, 0.02, 5);
        const auto error = [&](const ModelRun& run) {
            return std::abs(run.curves[quantity::deviatoric_stress].back() /
                                real.curves[quantity::deviatoric_stress].back() -
                            1);
        };
        CHECK(error(together) < 0.5 * error(without));
        CHECK(together.displacement.back()[0].z() == about(-0.02 * 1.7).epsilon(0.03));
    }

    TEST_CASE("no measurement is assimilated before its strain") {
        Learning learning;
        const RockParameters middle{0.5, 1};
        const Gaussian prior = prior_of(middle, learning);
        Ensemble members{draw_members(prior, 8), {}};
        for (const RockParameters& b : members.parameters)
            members.runs.push_back(simple_run(b, 0.01, members.runs.size()));
        Measurements one = Measurements{MeasuredCurves(simple_run({0.6, 1}, 0.01, 50).curves)},
                     other = one;
        for (std::size_t k = 0; k < other.curves.size(); ++k)
            if (other.curves[quantity::axial_strain][k] > 5e-3)
                other.curves[quantity::deviatoric_stress][k] *= 2;
        const auto a = learn(prior, members, one, learning, 0.01),
                   b = learn(prior, members, other, learning, 0.01);
        REQUIRE(a.size() == b.size());
        for (std::size_t k = 0; k < a.size(); ++k)
            CHECK((a[k].estimate.mean == b[k].estimate.mean) == (a[k].strain <= 5e-3));
    }

    TEST_CASE("a measurement at the end of a window is assimilated in that window only") {
        const Learning learning;
        const Gaussian prior = prior_of({0.5, 1}, learning);
        Ensemble members{draw_members(prior, 8), {}};
        for (const RockParameters& b : members.parameters)
            members.runs.push_back(simple_run(b, 0.01, members.runs.size()));
        const double end = window_ends(learning, 0.01).front();
        Measurements measured = Measurements{MeasuredCurves(simple_run({0.6, 1}, 0.01, 50).curves)};
        for (std::size_t k = 0; k < measured.curves[quantity::deviatoric_stress].size(); ++k)
            if (std::abs(measured.curves[quantity::axial_strain][k] - end) > 1e-9)
                measured.curves[quantity::deviatoric_stress][k] = std::nan("");
        const auto estimates = learn(prior, members, measured, learning, 0.01);
        REQUIRE(estimates.size() == 1);
        CHECK(estimates[0].strain == end);
    }

    TEST_CASE("outliers of q are left out and counted, and do not change the estimate") {
        const Learning learning{.specimen_scatter = 0.35};
        const Gaussian prior = prior_of({0.5, 1}, learning);
        Ensemble members{draw_members(prior, 8), {}};
        for (const RockParameters& b : members.parameters)
            members.runs.push_back(simple_run(b, 0.01, members.runs.size()));
        const Measurements good =
            Measurements{MeasuredCurves(simple_run({0.7, 0.6}, 0.01, 50).curves)};
        const auto learned = [&](auto&& change) {
            Measurements measured = good;
            for (std::size_t k = 0; k < measured.curves[quantity::deviatoric_stress].size(); ++k)
                measured.curves[quantity::deviatoric_stress][k] =
                    change(measured.curves[quantity::deviatoric_stress][k], k);
            return learn(prior, members, measured, learning, 0.01);
        };
        for (const EstimateAt& k : learned([](double q, std::size_t) { return q; }))
            CHECK(k.rejected == 0); // far from the prior, but not that far
        for (const EstimateAt& k :
             learned([](double q, std::size_t k) { return k > 40 ? 0.3 * q : q; }))
            CHECK(k.rejected == 0); // a slip of the specimen is no outlier
        const auto wild = learned([](double q, std::size_t k) { return k == 15 ? 1e12 : q; }),
                   without =
                       learned([](double q, std::size_t k) { return k == 15 ? std::nan("") : q; });
        REQUIRE(wild.size() == without.size());
        unsigned left_out = 0;
        for (std::size_t k = 0; k < wild.size(); ++k) {
            CHECK(wild[k].estimate.mean == without[k].estimate.mean);
            left_out += wild[k].rejected;
            CHECK((wild[k].rejected == 1) == (wild[k].strain > 1.5e-3 - 1e-9 &&
                                              (k == 0 || wild[k - 1].strain < 1.5e-3 - 1e-9)));
        }
        CHECK(left_out == 1);
        // q with a wrong gain everywhere counts as not measured, which is reported window by window
        const auto gain = learned([](double q, std::size_t) { return 30 * q; }),
                   none = learned([](double, std::size_t) { return std::nan(""); });
        CHECK(none.empty());
        REQUIRE(gain.size() == window_ends(learning, 0.01).size());
        CHECK(gain.back().estimate.mean == prior.mean);
        left_out = 0;
        for (const EstimateAt& k : gain) {
            CHECK(k.normalised_innovation_squared == -1);
            left_out += k.rejected;
        }
        CHECK(left_out == 100);
    }

    TEST_CASE("without q the volumetric strain alone updates the estimate, and the forecast stays "
              "finite") {
        const Learning learning{.specimen_scatter = 0.25, .by_sensors = false, .by_volume = true};
        const Gaussian prior = prior_of({0.5, 1}, learning);
        Measurements measured = Measurements{MeasuredCurves(dilating_run({0.7, 1}, 50).curves)};
        for (double& q : measured.curves[quantity::deviatoric_stress]) q = std::nan("");
        unsigned runs = 0;
        const auto run = [&](const std::vector<ModelVariant>& variants, double) {
            std::vector<ModelRun> all;
            for (const ModelVariant& variant : variants)
                all.push_back(dilating_run(variant.rocks, 100 + runs++));
            return all;
        };
        const Learned learned = learn_in_two_generations(prior, measured, learning, 0.01, run);
        REQUIRE_FALSE(learned.estimates.empty());
        const Gaussian& estimates = learned.estimates.back().estimate;
        CHECK(estimates.mean[0] > prior.mean[0]);
        CHECK(estimates.root.row(0).norm() < prior.root.row(0).norm());
        CHECK(estimates.root.row(1).norm() ==
              about(prior.root.row(1).norm()).epsilon(0.05)); // stiffness is not observable
        for (double& v : measured.curves[quantity::volumetric_strain]) v = std::nan("");
        const Learned nothing = learn_in_two_generations(prior, measured, learning, 0.01, run);
        CHECK(nothing.estimates.empty());
        const ModelRun forecast = ensemble_forecast(nothing, prior);
        for (const double q : forecast.curves[quantity::deviatoric_stress]) CHECK(std::isfinite(q));
    }

    TEST_CASE(
        "an ensemble member that a guard stops is left out, and too few members are an error") {
        const Learning learning;
        const Gaussian prior = prior_of({0.5, 1}, learning);
        const auto ensemble_without = [&](std::size_t stopped) {
            return run_members(prior, learning.members, "first", 2e-3,
                               [&](const std::vector<ModelVariant>& variants, double strain) {
                                   std::vector<ModelRun> runs;
                                   for (const ModelVariant& variant : variants)
                                       runs.push_back(
                                           simple_run(variant.rocks, strain, runs.size()));
                                   for (std::size_t k = 0; k < stopped; ++k)
                                       runs[2 * k + 1].stopped = "overlap";
                                   return runs;
                               });
        };
        const Ensemble all = ensemble_without(0), some = ensemble_without(2);
        REQUIRE(some.runs.size() == 6);
        REQUIRE(some.parameters.size() == 6);
        const std::array<std::size_t, 6> left{0, 2, 4, 5, 6, 7};
        for (std::size_t k = 0; k < 6; ++k) {
            CHECK(some.parameters[k].friction == all.parameters[left[k]].friction);
            CHECK(some.runs[k].curves[quantity::deviatoric_stress].back() ==
                  all.runs[left[k]].curves[quantity::deviatoric_stress].back());
        }
        CHECK_THROWS_AS(ensemble_without(3), SimulationError);
    }

    TEST_CASE("with specimen scatter the estimate of friction is less certain, and consistent with "
              "the truth") {
        // real specimens are stronger or weaker by a fifth for other reasons than friction
        double outside = 0, deviation = 0;
        constexpr int specimens = 12;
        for (int k = 0; k < specimens; ++k) {
            const Learning learning{.specimen_scatter = 0.2};
            Random random(static_cast<std::uint64_t>(k), 5);
            const Gaussian prior = prior_of({0.6, 1}, learning);
            Ensemble members{draw_members(prior, 10), {}};
            for (const RockParameters& b : members.parameters)
                members.runs.push_back(simple_run(b, 0.01, 20 + members.runs.size()));
            const RockParameters truth = mean_of(
                {prior.mean + prior.root * Vector::NullaryExpr(2, [&] { return random.normal(); }),
                 prior.covariance()});
            Measurements measured = Measurements{
                MeasuredCurves(simple_run(truth, 0.01, 50 + static_cast<std::uint64_t>(k)).curves)};
            const double stronger = std::exp(0.2 * random.normal());
            for (double& q : measured.curves[quantity::deviatoric_stress]) q *= stronger;
            const Gaussian after = learn(prior, members, measured, learning, 0.01).back().estimate;
            outside += squared_distance(after, logarithms_of(truth)) / specimens;
            deviation += after.root.row(0).norm() / specimens;
        }
        CHECK(outside < 3.4); // 2 expected; 99 % of chi squared with 24 degrees of freedom over 12
        CHECK(deviation > 0.12);
        CHECK(deviation < 0.27); // the prior has 0.3
    }

    TEST_CASE(
        "strength and dilation that specimens have in common are not attributed to friction, and "
        "the estimate is consistent with the truth") {
        double outside = 0;
        constexpr int specimens = 40;
        for (int k = 0; k < specimens; ++k) {
            const Learning learning{
                .specimen_scatter = 0.3, .by_sensors = false, .by_volume = true};
            Random random(static_cast<std::uint64_t>(k), 6);
            const Gaussian prior = prior_of({0.6, 1}, learning);
            Ensemble members{draw_members(prior, 8), {}};
            for (const RockParameters& b : members.parameters)
                members.runs.push_back(dilating_run(b, 20 + members.runs.size()));
            const RockParameters truth = mean_of(
                {prior.mean + prior.root * Vector::NullaryExpr(2, [&] { return random.normal(); }),
                 prior.covariance()});
            Measurements measured = Measurements{
                MeasuredCurves(dilating_run(truth, 50 + static_cast<std::uint64_t>(k)).curves)};
            const double both = random.normal(),
                         strength = std::sqrt(0.6) * both + std::sqrt(0.4) * random.normal(),
                         dilation = std::sqrt(0.6) * both + std::sqrt(0.4) * random.normal();
            for (double& q : measured.curves[quantity::deviatoric_stress])
                q *= std::exp(0.3 * strength);
            for (double& v : measured.curves[quantity::volumetric_strain]) v *= 1 + 0.3 * dilation;
            outside +=
                squared_distance(learn(prior, members, measured, learning, 0.01).back().estimate,
                                 logarithms_of(truth)) /
                specimens;
        }
        CHECK(outside < 2.7); // 2 expected; 99 % of chi squared with 80 degrees of freedom over 40
        CHECK(outside > 1);   // the estimate is not much too uncertain either
    }

    TEST_CASE(
        "volumetric strain improves the estimate of friction where it is requested and measured") {
        Learning learning{.specimen_scatter = 0.25, .by_sensors = false};
        const Gaussian prior = prior_of({0.5, 1}, learning);
        Ensemble members{draw_members(prior, 8), {}};
        for (const RockParameters& b : members.parameters)
            members.runs.push_back(dilating_run(b, members.runs.size()));
        Measurements measured = Measurements{MeasuredCurves(dilating_run({0.7, 1}, 50).curves)};
        const auto learned = [&] {
            return learn(prior, members, measured, learning, 0.01).back().estimate;
        };
        const Gaussian by_q = learned();
        learning.by_volume = true;
        const Gaussian by_both = learned();
        for (double& v : measured.curves[quantity::volumetric_strain]) v = std::nan("");
        const Gaussian unmeasured = learned();
        // at the end ln q varies as 0.65 ln friction and 0.19 ln stiffness (with a prior deviation
        // of 0.4), dilation as 0.89 ln friction; specimens scatter by 0.25 in each, with a
        // correlation of 0.6 between them
        const double q = std::hypot(0.25, 0.19 * 0.4) / 0.65, dilation = 0.25 / 0.89;
        const double both =
            (1 - 0.6 * 0.6) / (1 / (q * q) + 1 / (dilation * dilation) - 2 * 0.6 / (q * dilation));
        CHECK(by_q.root.row(0).norm() ==
              about(1 / std::sqrt(1 / 0.09 + 1 / (q * q))).epsilon(0.15));
        CHECK(by_both.root.row(0).norm() ==
              about(1 / std::sqrt(1 / 0.09 + 1 / both)).epsilon(0.15));
        // if the scatter of the two were independent
        const double if_alone = 1 / std::sqrt(1 / 0.09 + 1 / (q * q) + 1 / (dilation * dilation));
        CHECK(by_both.root.row(0).norm() > 1.1 * if_alone);
        CHECK(by_both.mean[0] > by_q.mean[0]);
        CHECK(unmeasured.mean == by_q.mean);
    }

    TEST_CASE("friction is estimated from the outward displacement of sensor rocks without a load "
              "cell, but not from tilt alone") {
        Learning learning;
        const Gaussian prior = prior_of({0.5, 1}, learning);
        Ensemble members{draw_members(prior, 8), {}};
        for (const RockParameters& b : members.parameters)
            members.runs.push_back(widening_run(b, members.runs.size()));
        const ModelRun truth = widening_run({0.7, 1}, 50);
        Measurements measured = Measurements{MeasuredCurves(truth.curves)};
        measured.trajectories =
            recorded_trajectories(truth, sensor_rocks(truth), 1e-3, 1e-6, 1e-3, 1);
        measured.displacement_noise = 1e-6;
        const auto learned = [&] { return learn(prior, members, measured, learning, 0.01); };
        const auto by_both = learned();
        CHECK(outlying_displacements(members, measured) == 0);
        learning.by_force = false;
        const auto by_sensors = learned();
        CHECK(by_sensors.back().normalised_innovation_squared == -1);
        CHECK(std::abs(mean_of(by_sensors.back().estimate).friction - 0.7) < 0.03);
        CHECK(by_sensors.back().estimate.root.row(0).norm() < 0.1 * prior.root.row(0).norm());
        CHECK(
            by_sensors.back().estimate.root.row(1).norm() ==
            about(prior.root.row(1).norm()).epsilon(0.15)); // widening does not depend on stiffness
        learning.by_sensors = false;
        CHECK(learned().empty());
        learning.by_force = true;
        const auto by_force = learned();
        CHECK(by_force.back().estimate.root.row(0).norm() >
              1.5 * by_both.back().estimate.root.row(0).norm());
        // displacements that are not measured have no effect
        learning.by_sensors = true;
        SensorTrajectory& trajectory = measured.trajectories.front();
        trajectory.displacement.back() += Vec3(0.1, 0, 0);
        CHECK(outlying_displacements(members, measured) == 1);
        std::ranges::fill(trajectory.displacement, Vec3::Constant(std::nan("")));
        const auto by_tilt = learned();
        REQUIRE(by_tilt.size() == by_force.size());
        for (std::size_t k = 0; k < by_tilt.size(); ++k)
            CHECK(by_tilt[k].estimate.mean == by_force[k].estimate.mean);
        CHECK(outlying_displacements(members, measured) == 0);
    }

    TEST_CASE("a given first generation gives the same estimates as one that is run anew") {
        const Learning learning;
        const Gaussian prior = prior_of({0.5, 1}, learning);
        const Measurements measured =
            Measurements{MeasuredCurves(simple_run({0.7, 1}, 0.02, 77).curves)};
        unsigned runs = 0;
        const RunModels run = [&](const std::vector<ModelVariant>& variants, double strain) {
            std::vector<ModelRun> all;
            for (const ModelVariant& variant : variants)
                all.push_back(simple_run(variant.rocks, strain, 100 + runs++));
            return all;
        };
        const Learned whole = learn_in_two_generations(prior, measured, learning, 0.02, run);
        runs = learning.members;
        const Learned continued = learn_on(prior, whole.first, measured, learning, 0.02, run);
        CHECK(runs == 2 * learning.members);
        REQUIRE(continued.estimates.size() == whole.estimates.size());
        for (std::size_t k = 0; k < whole.estimates.size(); ++k)
            CHECK(continued.estimates[k].estimate.mean == whole.estimates[k].estimate.mean);
    }

    TEST_CASE(
        "the parameters of the ensemble members have the mean and covariance of the estimate") {
        Gaussian g(2);
        g.mean << -0.5, 0.1;
        g.root << 0.3, 0, 0.1, 0.2;
        const auto members = draw_members(g, 400);
        Vector mean = Vector::Zero(2);
        Matrix covariance = Matrix::Zero(2, 2);
        for (const RockParameters& b : members) mean += logarithms_of(b) / 400;
        for (const RockParameters& b : members)
            covariance += (logarithms_of(b) - mean) * (logarithms_of(b) - mean).transpose() / 400;
        CHECK((mean - g.mean).norm() < 0.01);
        CHECK((covariance - g.covariance()).norm() < 0.01);
    }

    TEST_CASE("a model run is given new parameters only when they change significantly") {
        const auto estimates = [](double strain, double friction, double deviation) {
            Gaussian g(2);
            g.mean = logarithms_of({friction, 1});
            g.root.diagonal() << deviation, 0.1;
            return EstimateAt{strain, g, 0};
        };
        const auto schedule = schedule_of({estimates(1e-3, 0.51, 0.01), estimates(2e-3, 0.6, 0.01),
                                           estimates(3e-3, 0.61, 0.01), estimates(4e-3, 0.7, 0.3)},
                                          {0.5, 1}, 0.03);
        REQUIRE(schedule.size() == 1);
        CHECK(schedule[0].strain == 2e-3);
        CHECK(schedule[0].rocks.friction == about(0.6));
    }

    TEST_CASE(
        "the second generation is drawn twice as wide as the estimate, and neither wider than "
        "the prior nor narrower than a third of it") {
        Gaussian prior(2);
        prior.root.diagonal() << 0.3, 0.4;
        const auto deviations_around = [&](double friction, double stiffness) {
            Gaussian estimate(2);
            estimate.mean << -0.2, 0.5;
            estimate.root.diagonal() << friction, stiffness;
            const Gaussian around = spread_around(prior, {{1e-3, estimate, 0}});
            CHECK(around.mean == estimate.mean);
            return around.root;
        };
        const Matrix inside = deviations_around(0.1, 0.15), beyond = deviations_around(0.01, 0.35);
        CHECK(inside(0, 0) == about(0.2).epsilon(1e-12));
        CHECK(inside(1, 1) == about(0.3).epsilon(1e-12));
        CHECK(beyond(0, 0) == about(0.3 * 0.3).epsilon(1e-12));
        CHECK(beyond(1, 1) == about(0.4).epsilon(1e-12));
    }

    TEST_CASE("four sensor rocks with the same motion count as one with half of the noise") {
        Learning learning;
        learning.by_force = false;
        const Gaussian prior = prior_of({0.5, 1}, learning);
        const auto learned = [&](std::size_t sensors, double noise) {
            const auto run_of = [&](const RockParameters& rocks, std::uint64_t seed) {
                ModelRun run = widening_run(rocks, seed);
                run.sensors = sensors;
                run.start.resize(sensors, run.start[0]);
                for (auto& stage : run.displacement) stage.resize(sensors, stage[0]);
                for (auto& stage : run.rotation) stage.resize(sensors, stage[0]);
                return run;
            };
            Ensemble members{draw_members(prior, 8), {}};
            for (const RockParameters& b : members.parameters)
                members.runs.push_back(run_of(b, members.runs.size()));
            const ModelRun truth = run_of({0.7, 1}, 50);
            Measurements measured = Measurements{MeasuredCurves(truth.curves)};
            measured.trajectories =
                recorded_trajectories(truth, sensor_rocks(truth), 1e-3, 0, 0, 1);
            measured.displacement_noise = noise;
            return learn(prior, members, measured, learning, 0.01).back().estimate;
        };
        const Gaussian one = learned(1, 1e-4), four = learned(4, 2e-4);
        CHECK((one.mean - four.mean).norm() < 1e-9);
        CHECK((one.root - four.root).norm() < 1e-9);
        CHECK((one.root - learned(4, 1e-4).root).norm() > 0.01 * one.root.norm());
    }

    TEST_CASE("measurements have less weight by as much as members are farther from the estimates "
              "of the others than these claim") {
        const Learning learning;
        const Gaussian wide = prior_of({0.5, 1}, learning);
        Gaussian prior = wide; // too narrow for the members, whose estimates are therefore too sure
        prior.root *= 0.5;
        Ensemble members{draw_members(wide, 7), {}};
        for (const RockParameters& b : members.parameters)
            members.runs.push_back(simple_run(b, 0.01, members.runs.size()));
        const auto learned = [&](const Ensemble& ensemble, const ModelRun& truth) {
            Measurements measured = Measurements{MeasuredCurves(truth.curves)};
            for (std::size_t k = 0; k < measured.curves[quantity::deviatoric_stress].size(); ++k)
                if (std::abs(measured.curves[quantity::axial_strain][k] - 0.01) > 1e-9)
                    measured.curves[quantity::deviatoric_stress][k] = std::nan("");
            return learn(prior, ensemble, measured, learning, 0.01).back().estimate;
        };
        double sum = 0;
        Vector forecast(7);
        for (std::size_t j = 0; j < 7; ++j) {
            Ensemble others = members; // six, too few for a weight other than 1
            others.parameters.erase(others.parameters.begin() + static_cast<std::ptrdiff_t>(j));
            others.runs.erase(others.runs.begin() + static_cast<std::ptrdiff_t>(j));
            sum += squared_distance(learned(others, members.runs[j]),
                                    logarithms_of(members.parameters[j]));
            forecast[static_cast<Eigen::Index>(j)] =
                std::log(members.runs[j].curves[quantity::deviatoric_stress].back());
        }
        const double weight = 2 * 7 / sum; // two parameters
        REQUIRE(weight < 0.8);
        const ModelRun truth = simple_run({0.6, 1.1}, 0.01, 50);
        ParameterEstimate expected(prior, logarithms_of(members.parameters), 1, weight);
        expected.observe(0, forecast,
                         {std::log(truth.curves[quantity::deviatoric_stress].back()),
                          learning.force_noise, 0, std::log(0.01)});
        const Gaussian found = learned(members, truth);
        CHECK((found.mean - expected.parameters().mean).norm() < 1e-9);
        CHECK((found.covariance() - expected.parameters().covariance()).norm() < 1e-9);
    }
}

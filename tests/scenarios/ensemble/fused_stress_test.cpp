#include "engine/random.hpp"
#include "scenarios/ensemble/fused_stress.hpp"
#include "scenarios/ensemble/specimen_correlation.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

namespace {

constexpr std::size_t stages = 100;

/// ln q of a specimen: friction and stiffness, the packing, which changes along the test by
/// `wander`, and slips that are correlated from stage to stage.
ModelRun run_of(const RockParameters& rocks, double packing, std::uint64_t seed,
                double wander = 0) {
    Random random(seed, 3);
    ModelRun run;
    double slip = 0.05 * random.normal();
    for (std::size_t k = 0; k <= stages; ++k) {
        const double strain = 1e-4 * static_cast<double>(k);
        slip = 0.9 * slip + std::sqrt(1 - 0.81) * 0.05 * random.normal();
        const double q =
            3e5 * (1 - std::exp(-400 * strain)) * rocks.friction * std::sqrt(rocks.stiffness);
        if (k > 1 && wander > 0) { // an Ornstein-Uhlenbeck process in ln strain
            const double stays =
                std::exp(-std::log(static_cast<double>(k) / static_cast<double>(k - 1)) /
                         specimen_correlation.memory);
            packing = stays * packing + std::sqrt(1 - stays * stays) * wander * random.normal();
        }
        const auto row = run.curves.add_row();
        row[quantity::axial_strain] = strain;
        row[quantity::deviatoric_stress] = q * std::exp(packing + slip);
    }
    return run;
}

Ensemble members_of(const Gaussian& prior, std::uint64_t seed) {
    Ensemble members;
    members.parameters = draw_members(prior, 8);
    for (const RockParameters& p : members.parameters)
        members.runs.push_back(run_of(p, 0, 100 * seed + members.runs.size()));
    return members;
}

struct Scene {
    Learning learning{.specimen_scatter = 0.35};
    Gaussian prior = prior_of({0.7, 1}, learning);
    Ensemble members;
    explicit Scene(std::uint64_t seed) : members(members_of(prior, seed)) {}
    FusedStress at(const MeasuredCurves& test, std::size_t stage) const {
        return fused_stress(members, prior, test, learning, stage);
    }
};

} // namespace

TEST_SUITE("ensemble/fused_stress") {
    TEST_CASE("of a specimen of another packing, the next measured q lies within the band of fused "
              "in about 95 % of the stages, and the band is narrower than specimens scatter") {
        unsigned inside = 0, all = 0;
        double width = 0;
        for (std::uint64_t seed = 1; seed <= 8; ++seed) {
            const Scene scene(seed);
            Random random(seed, 5);
            const MeasuredCurves test =
                MeasuredCurves(run_of({0.7, 1}, 0.35 * random.normal(), 7000 + seed, 0.35).curves);
            for (std::size_t stage = 5; stage <= stages; stage += 5) {
                const FusedStress f = scene.at(test, stage);
                REQUIRE(std::isfinite(f.fused));
                inside += static_cast<unsigned>(std::abs(f.measured - f.fused) <= f.half_width);
                width += f.half_width / f.fused;
                ++all;
            }
        }
        CHECK(inside > 0.9 * all);
        CHECK(inside < all); // or the band would say nothing
        CHECK(width / all < 0.2);
    }

    TEST_CASE("the prediction of a stage does not use its record") {
        const Scene scene(1);
        MeasuredCurves test = MeasuredCurves(run_of({0.7, 1}, 0.2, 7001).curves);
        const FusedStress before = scene.at(test, 50);
        test[quantity::deviatoric_stress][50] *= 3;
        const FusedStress after = scene.at(test, 50);
        CHECK(after.fused == before.fused);
        CHECK(after.measured == 3 * before.measured);
    }

    TEST_CASE("a model that has a sixteenth of the measured q disagrees, one of another packing "
              "does not") {
        const Scene scene(2);
        using enum FusedStress::Agreement;
        const MeasuredCurves like = MeasuredCurves(run_of({0.7, 1}, 0.35, 7002).curves),
                             other = MeasuredCurves(run_of({0.7, 1}, std::log(16), 7002).curves);
        CHECK(scene.at(like, 60).agreement == agrees);
        CHECK(scene.at(other, 60).agreement == disagrees);
        CHECK(scene.at(other, 1).agreement == disagrees); // from the first record on
        CHECK(scene.at(other, 60).reason.find("times that of the model") != std::string::npos);
    }

    TEST_CASE("a test that breaks out of the band disagrees from the third stage on") {
        const Scene scene(3);
        MeasuredCurves test = MeasuredCurves(run_of({0.7, 1}, 0, 7003).curves);
        double factor = 1;
        for (std::size_t k = 60; k < test[quantity::deviatoric_stress].size(); ++k)
            test[quantity::deviatoric_stress][k] *= factor *= 0.75;
        CHECK(scene.at(test, 59).agreement == FusedStress::Agreement::agrees);
        CHECK(scene.at(test, 63).agreement == FusedStress::Agreement::disagrees);
    }

    TEST_CASE(
        "without a record, nothing is said; a model without stress disagrees with a test that "
        "has some") {
        Scene scene(4);
        MeasuredCurves test = MeasuredCurves(run_of({0.7, 1}, 0, 7004).curves);
        MeasuredCurves none;
        CHECK(scene.at(none, 10).agreement == FusedStress::Agreement::unknown);
        test[quantity::deviatoric_stress][10] = std::nan("");
        CHECK(scene.at(test, 10).agreement == FusedStress::Agreement::unknown);
        for (ModelRun& run : scene.members.runs)
            for (double& q : run.curves[quantity::deviatoric_stress]) q = 500;
        const FusedStress f = scene.at(test, 20);
        CHECK(f.agreement == FusedStress::Agreement::disagrees);
        CHECK(std::isnan(f.fused));
    }
}

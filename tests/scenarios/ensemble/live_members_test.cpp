#include "scenarios/ensemble/live_model.hpp"
#include "scenarios/ensemble/run_models.hpp"
#include "scenarios/ensemble/variant_run.hpp"
#include "tests/scenarios/ensemble/small_specimen.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <iterator>

using namespace bris;

namespace {

/// The records of a synthetic test, up to a stage of a true run.
RecordedTest recorded(const ModelRun& truth, std::size_t stage) {
    RecordedTest test;
    for (std::size_t s = 0; s < truth.sensors; ++s) {
        test.recordings.emplace_back().info.displacement_noise = 1e-6;
        SensorTrajectory& trajectory = test.trajectories.emplace_back();
        for (std::size_t k = 3; k <= stage; k += 3) {
            trajectory.strain.push_back(truth.curves[quantity::axial_strain][k]);
            trajectory.displacement.push_back(truth.displacement[k][s]);
            trajectory.rotation.push_back(truth.rotation[k][s]);
            trajectory.tilt.push_back(Vec3::Constant(std::nan("")));
        }
    }
    test.curves =
        MeasuredCurves(truth.curves.rows_where([&](std::size_t k) { return k <= stage; }));
    test.displacement_noise = 1e-6;
    return test;
}

/// A specimen, and a model of it that can be made repeatedly.
struct Live {
    TriaxialScene scene = testing::small_scene();
    TriaxialSettings settings = testing::short_test();
    Archive specimen = testing::prepared(scene);
    ModelRun truth = run_model(scene, settings, specimen, {.rocks = {0.6, 1.2}});
    Progress progress{Progress::Style::quiet};

    LiveModel model(const Common& common) {
        Learning learning;
        learning.members = 6;
        learning.first_strain = 4e-4;
        return LiveModel(
            {{0.5, 1}, learning, settings.stage_strain, settings.final_axial_strain, 2},
            [&](const std::vector<ModelVariant>& variants) {
                return begin_models(scene, settings, specimen, variants, common, progress);
            });
    }
    void follow(LiveModel& model, std::size_t stages) const {
        while (model.state().curves.size() < stages) {
            model.next_stage(recorded(truth, model.state().curves.size()));
            model.advance_members();
        }
    }
};

Common common_in(const std::filesystem::path& out, unsigned threads) {
    Common common;
    common.out = out;
    common.threads = threads;
    common.quiet = true;
    return common;
}

void check_same_bits(const LiveModel& a, const LiveModel& b) {
    CHECK(a.state().displacement == b.state().displacement);
    CHECK(a.state().rotation == b.state().rotation);
    CHECK(a.forecast().displacement == b.forecast().displacement);
    REQUIRE(a.state().curves.size() == b.state().curves.size());
    for (std::size_t k = 0; k < a.state().curves.size(); ++k)
        CHECK(a.state().curves[quantity::deviatoric_stress][k] ==
              b.state().curves[quantity::deviatoric_stress][k]);
    CHECK(a.estimate().mean == b.estimate().mean);
    CHECK(a.estimate().root == b.estimate().root);
    CHECK(a.caught_up_at() == b.caught_up_at());
}

std::size_t files_in(const std::filesystem::path& folder) {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder),
                                                  std::filesystem::directory_iterator()));
}

} // namespace

TEST_SUITE("ensemble/live_members") {
    TEST_CASE("a model stopped before, while and after its second generation catches up resumes to "
              "the same bits, on one thread or two") {
        Live live;
        const TemporaryDirectory whole, parts;
        const Common once = common_in(whole.path(), 2);
        LiveModel model = live.model(once);
        live.follow(model, 21);
        REQUIRE(model.done());
        REQUIRE(model.caught_up_at() > 8e-4);
        REQUIRE(model.caught_up_at() < 15e-4);
        Common again = common_in(parts.path(), 1);
        again.resume = again.out;
        std::size_t last = 0;
        // stopped there, then begun again from the start
        for (const std::size_t stages : {std::size_t{3}, std::size_t{7}, std::size_t{16}}) {
            LiveModel stopped = live.model(again);
            live.follow(stopped, stages);
            stopped.save_checkpoint();
            const std::size_t files = files_in(parts / "runs");
            CHECK(files == (stages > 5 ? 12 : 6));
            CHECK(stages > last);
            last = stages;
        }
        again.threads = 2;
        LiveModel gone_on = live.model(again);
        live.follow(gone_on, 21);
        check_same_bits(gone_on, model);
    }

    TEST_CASE("stages of ensemble members that were saved are not run again, and not used before "
              "their turn") {
        Live live;
        const TemporaryDirectory folder;
        Common common = common_in(folder.path(), 2);
        const std::vector<ModelVariant> variants{{.name = "one", .rocks = {0.7, 1}},
                                                 {.name = "other", .rocks = {0.5, 1}}};
        std::vector<ModelRun> runs, again;
        const ConcurrentRuns first =
            begin_models(live.scene, live.settings, live.specimen, variants, common, live.progress);
        first.advance(runs, 9);
        first.save_checkpoint();
        common.resume = common.out;
        unsigned blocks = 0;
        CheckpointedRun checkpoint(common, live.settings, live.specimen, variants[1]);
        VariantRun resumed(live.scene, live.settings, live.specimen, variants[1],
                           {.progress = [&](const PhaseProgress&) { ++blocks; }}, &checkpoint);
        resumed.advance_to(9);
        CHECK(blocks == 0);
        const ConcurrentRuns second =
            begin_models(live.scene, live.settings, live.specimen, variants, common, live.progress);
        for (const std::size_t points : {std::size_t{2}, std::size_t{5}, std::size_t{12}}) {
            second.advance(again, points);
            CHECK(again[0].curves.size() == points);
            CHECK(again[1].displacement.size() == points);
        }
        first.advance(runs, 12);
        for (std::size_t k = 0; k < 2; ++k) {
            CHECK(again[k].displacement == runs[k].displacement);
            CHECK(again[k].rotation == runs[k].rotation);
            CHECK(again[k].rocks == runs[k].rocks);
            CHECK(again[k].curves[quantity::deviatoric_stress].back() ==
                  runs[k].curves[quantity::deviatoric_stress].back());
        }
    }
}

#include "scenarios/ensemble/run_models.hpp"

#include "engine/ensemble.hpp"
#include "engine/errors.hpp"
#include "scenarios/ensemble/checkpointed_run.hpp"
#include "scenarios/ensemble/variant_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>

namespace bris {

namespace {

std::string stopped_by(const SimulationError& error, const ModelVariant& variant) {
    return fmt::format("{} (friction {:.3g}, stiffness {:.3g}): {}", variant.name,
                       variant.rocks.friction, variant.rocks.stiffness, error.what());
}

/// The specimen that a variant starts from.
struct Start {
    const TriaxialScene& scene;
    const Archive& specimen;
};

std::vector<ModelRun> try_from(const std::vector<Start>& starts, const TriaxialSettings& settings,
                               const std::vector<ModelVariant>& variants, double strain,
                               const Common& common, Progress& progress) {
    TriaxialSettings test = settings;
    test.final_axial_strain = std::min(strain, test.final_axial_strain);
    std::vector<ModelRun> runs(variants.size());
    run_ensemble(variants.size(), common.threads, [&](std::size_t k) {
        const auto& [scene, specimen] = starts[k];
        CheckpointedRun checkpoint(common, test, specimen, variants[k]);
        try {
            runs[k] =
                run_model(scene, test, specimen, variants[k], watch_on(progress, k), &checkpoint);
        } catch (const SimulationError& error) {
            runs[k].stopped = stopped_by(error, variants[k]);
        }
    });
    progress.pause();
    return runs;
}

/// Adds to `sum` the stages of a run that it does not have yet, up to a number of points.
void add_stages(ModelRun& sum, const ModelRun& run, std::size_t points) {
    if (sum.curves.empty()) sum = empty_run_like(run);
    for (std::size_t k = sum.curves.size(); k < std::min(points, run.curves.size()); ++k) {
        sum.curves.add_row_of(run.curves, k);
        sum.displacement.push_back(run.displacement[k]);
        sum.rotation.push_back(run.rotation[k]);
    }
}

/// Runs that advance together.
class RunsTogether {
public:
    RunsTogether(const TriaxialScene& scene, const TriaxialSettings& settings,
                 const Archive& specimen, const std::vector<ModelVariant>& variants,
                 const Common& common, Progress& progress, WatchModels watch)
        : scene_(scene), settings_(settings), specimen_(specimen), common_(common),
          progress_(progress), watch_(std::move(watch)) {
        for (const ModelVariant& variant : variants)
            members_.push_back(std::make_unique<Member>(
                Member{CheckpointedRun(common, settings_, specimen, variant), variant, nullptr}));
    }

    void advance(std::vector<ModelRun>& runs, std::size_t points) {
        runs.resize(members_.size());
        run_ensemble(members_.size(), common_.threads, [&](std::size_t k) {
            try {
                advance(k, points);
                add_stages(runs[k], members_[k]->run->run(), points);
            } catch (const SimulationError& error) {
                runs[k].stopped = stopped_by(error, members_[k]->variant);
            }
        });
        for (std::size_t k = runs.size(); k-- > 0;)
            if (!runs[k].stopped.empty()) {
                progress_.pause();
                members_.erase(members_.begin() + static_cast<std::ptrdiff_t>(k));
            }
    }
    void save_checkpoint() {
        for (const auto& member : members_)
            if (member->run) member->run->save_checkpoint();
    }

private:
    struct Member {
        CheckpointedRun checkpoint;
        ModelVariant variant;
        std::unique_ptr<VariantRun> run; // null: not begun
    };
    void advance(std::size_t k, std::size_t points) {
        Member& member = *members_[k];
        if (!member.run) {
            ModelWatch watched = watch_on(progress_, k);
            if (watch_)
                watched.progress = [this, k, shown = watched.progress](const PhaseProgress& now) {
                    shown(now);
                    watch_(k, now);
                };
            member.run = std::make_unique<VariantRun>(scene_, settings_, specimen_, member.variant,
                                                      watched, &member.checkpoint);
        }
        member.run->advance_to(points);
    }

    const TriaxialScene& scene_;
    TriaxialSettings settings_;
    const Archive& specimen_;
    const Common& common_;
    Progress& progress_;
    WatchModels watch_;
    // by pointer, since the run of a member refers to its checkpoint
    std::vector<std::unique_ptr<Member>> members_;
};

} // namespace

ModelWatch watch_on(Progress& progress, std::size_t model) {
    return {.progress = progress_slot(progress, static_cast<unsigned>(model))};
}

std::vector<ModelRun> try_models(const TriaxialScene& scene, const TriaxialSettings& settings,
                                 const Archive& specimen, const std::vector<ModelVariant>& variants,
                                 double strain, const Common& common, Progress& progress) {
    return try_from(std::vector<Start>(variants.size(), {scene, specimen}), settings, variants,
                    strain, common, progress);
}

std::vector<ModelRun> run_models(const std::vector<const PreparedSpecimen*>& specimens,
                                 const TriaxialSettings& settings,
                                 const std::vector<ModelVariant>& variants, double strain,
                                 const Common& common, Progress& progress) {
    require(specimens.size() == variants.size(),
            fmt::format("models: expected a specimen for each of {} variants, found {}",
                        variants.size(), specimens.size()));
    std::vector<Start> starts;
    for (const PreparedSpecimen* specimen : specimens)
        starts.push_back({specimen->scene, specimen->state});
    auto runs = try_from(starts, settings, variants, strain, common, progress);
    for (const ModelRun& run : runs)
        if (!run.stopped.empty()) throw SimulationError(run.stopped);
    return runs;
}

ConcurrentRuns begin_models(const TriaxialScene& scene, const TriaxialSettings& settings,
                            const Archive& specimen, const std::vector<ModelVariant>& variants,
                            const Common& common, Progress& progress, const WatchModels& watch) {
    const auto together = std::make_shared<RunsTogether>(scene, settings, specimen, variants,
                                                         common, progress, watch);
    return {[together](std::vector<ModelRun>& runs, std::size_t points) {
                together->advance(runs, points);
            },
            [together] { together->save_checkpoint(); }};
}

} // namespace bris

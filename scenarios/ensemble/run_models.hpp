#pragma once

#include "engine/archive.hpp"
#include "engine/run.hpp"
#include "scenarios/ensemble/model_ensemble.hpp"
#include "scenarios/ensemble/model_run.hpp"
#include "scenarios/triaxial/make_specimen.hpp"

#include <functional>
#include <string>
#include <vector>

namespace bris {

/// A specimen before the confining pressure is applied, and the scene that it was made from.
struct PreparedSpecimen {
    TriaxialScene scene;
    Archive state;
};

/// Runs several variants to an axial strain (at most to the end of the test), `threads` at a time,
/// each with its checkpoint in the results folder. A run that a guard stops has its `stopped` set
/// and does not affect the others.
std::vector<ModelRun> try_models(const TriaxialScene& scene, const TriaxialSettings& settings,
                                 const Archive& specimen, const std::vector<ModelVariant>& variants,
                                 double strain, const Common& common, Progress& progress);
/// The same with a specimen for each variant. Throws InputError unless there is one for each, and
/// SimulationError if a guard stopped a run.
std::vector<ModelRun> run_models(const std::vector<const PreparedSpecimen*>& specimens,
                                 const TriaxialSettings& settings,
                                 const std::vector<ModelVariant>& variants, double strain,
                                 const Common& common, Progress& progress);

/// Begins runs of several variants that advance together, step by step as requested, `threads` at a
/// time; all of them are in memory at once, with checkpoints in the results folder. The sizes of
/// the steps do not change a bit of the results. Scene, specimen, `common` and `progress` have to
/// outlive the runs. `watch`: told the progress of each, too, by several threads at once.
using WatchModels = std::function<void(std::size_t model, const PhaseProgress&)>;
ConcurrentRuns begin_models(const TriaxialScene& scene, const TriaxialSettings& settings,
                            const Archive& specimen, const std::vector<ModelVariant>& variants,
                            const Common& common, Progress& progress,
                            const WatchModels& watch = {});

/// Reports the progress of one of several models.
ModelWatch watch_on(Progress& progress, std::size_t model);

} // namespace bris

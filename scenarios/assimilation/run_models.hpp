#pragma once

#include "engine/archive.hpp"
#include "engine/run.hpp"
#include "scenarios/assimilation/model_ensemble.hpp"
#include "scenarios/assimilation/model_run.hpp"
#include "scenarios/triaxial/make_specimen.hpp"

#include <functional>
#include <string>
#include <vector>

namespace bris {

/// A specimen where the pressure begins to matter, and the scene it was made from.
struct PreparedSpecimen {
    TriaxialScene scene;
    Archive state;
};

/// Runs several to an axial strain (no farther than the test goes), `threads` at a time, each kept
/// in the folder of the results. One that a guard stops says so and leaves the others alone.
std::vector<ModelRun> try_models(const TriaxialScene& scene, const TriaxialSettings& settings,
                                 const Archive& specimen, const std::vector<ModelVariant>& variants,
                                 double strain, const Common& common, Progress& progress);
/// The same, each arm on a specimen of its own. Throws SimulationError if one was stopped.
std::vector<ModelRun> run_models(const std::vector<const PreparedSpecimen*>& specimens,
                                 const TriaxialSettings& settings,
                                 const std::vector<ModelVariant>& variants, double strain,
                                 const Common& common, Progress& progress);

/// Several that go on together, as far as they are asked to, `threads` at a time; in memory all at
/// once, and kept in the folder of the results. How far they are asked to at a time changes no bit.
/// Scene, specimen, `common` and `progress` have to outlive them.
ConcurrentRuns begin_models(const TriaxialScene& scene, const TriaxialSettings& settings,
                            const Archive& specimen, const std::vector<ModelVariant>& variants,
                            const Common& common, Progress& progress);

/// Who watches one of several models on a progress line.
ModelWatch watch_on(Progress& progress, std::size_t model, const Common& common);
/// The line for them.
Progress progress_of_models(const Common& common);

} // namespace bris

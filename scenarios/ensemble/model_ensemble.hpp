#pragma once

#include "engine/estimation/kalman.hpp"
#include "scenarios/ensemble/model_run.hpp"

#include <functional>
#include <string>
#include <vector>

namespace bris {

/// Logarithms of friction and stiffness: of one set of parameters (2), or of N sets (N x 2).
Vector logarithms_of(const RockParameters& rocks);
Matrix logarithms_of(const std::vector<RockParameters>& parameters);
/// The parameters at the mean of the estimate of their logarithms.
RockParameters mean_of(const Gaussian& estimate);
/// Parameters of `members` ensemble members, spread evenly over the distribution.
std::vector<RockParameters> draw_members(const Gaussian& estimate, unsigned members);

/// Ensemble members: their parameters, and the runs that they forecast.
struct Ensemble {
    std::vector<RockParameters> parameters;
    std::vector<ModelRun> runs;
};

/// Runs some variants to an axial strain.
using RunModels =
    std::function<std::vector<ModelRun>(const std::vector<ModelVariant>&, double strain)>;

/// Runs of several variants that advance together, step by step as requested.
struct ConcurrentRuns {
    /// Adds stages to each run until it has `points` points (one at the start, one for each stage).
    /// A run that a guard stopped has its `stopped` set and is not among the runs of the next call:
    /// the caller has to remove it, too.
    std::function<void(std::vector<ModelRun>& runs, std::size_t points)> advance;
    /// Saves checkpoints, from which the runs resume when the same variants begin again.
    std::function<void()> save_checkpoint = [] {};
};
using BeginRuns = std::function<ConcurrentRuns(const std::vector<ModelVariant>&)>;

/// Runs a generation of `members` ensemble members, drawn from the estimate, to an axial strain.
/// Members that a guard stopped are reported and left out; throws SimulationError if fewer remain
/// than the regression needs.
Ensemble run_members(const Gaussian& estimate, unsigned members, const std::string& name,
                     double strain, const RunModels& run);

/// A generation of ensemble members that advances along with a test.
class GrowingEnsemble {
public:
    GrowingEnsemble(const Gaussian& estimate, unsigned members, const std::string& name,
                    const BeginRuns& begin);
    /// Advances all members until they have so many points. Throws as run_members does.
    void advance_to(std::size_t points);
    std::size_t points() const {
        return ensemble_.runs.empty() ? 0 : ensemble_.runs.front().curves.size();
    }
    const Ensemble& members() const { return ensemble_; }
    void save_checkpoint() const { runs_.save_checkpoint(); }

private:
    Ensemble ensemble_;
    ConcurrentRuns runs_;
};

/// A run without stages, with the rocks and sensors of another.
ModelRun empty_run_like(const ModelRun& run);
/// Adds the next stage to `sum`: the ensemble forecast for the logarithms `at` of the parameters,
/// which is the regression of the members on their parameters.
void forecast_stage(ModelRun& sum, const Ensemble& members, const Vector& at);

} // namespace bris

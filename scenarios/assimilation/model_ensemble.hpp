#pragma once

#include "engine/estimation/kalman.hpp"
#include "scenarios/assimilation/model_run.hpp"

#include <functional>
#include <string>
#include <vector>

namespace bris {

/// Logarithms of friction and stiffness, of one or (N x 2) of each of several.
Vector logarithms_of(const RockParameters& rocks);
Matrix logarithms_of(const std::vector<RockParameters>& parameters);
RockParameters mean_of(const Gaussian& estimate);
/// Beliefs of `members` worlds, spread evenly over a distribution.
std::vector<RockParameters> draw_members(const Gaussian& estimate, unsigned members);

/// Worlds that differ in what they believe, and what they foretold.
struct Ensemble {
    std::vector<RockParameters> parameters;
    std::vector<ModelRun> runs;
};

/// The runs of some arms to an axial strain.
using RunModels =
    std::function<std::vector<ModelRun>(const std::vector<ModelVariant>&, double strain)>;

/// Runs of some arms that go on together, as far as they are asked to.
struct ConcurrentRuns {
    /// Adds to each run until it has so many points (one at the start, one for each stage). One
    /// that a guard stopped says so and is not among those of the next call: the caller drops it,
    /// too.
    std::function<void(std::vector<ModelRun>& runs, std::size_t points)> advance;
    /// Where they are now, to be taken up from there when the same arms begin anew.
    std::function<void()> save_checkpoint = [] {};
};
using BeginRuns = std::function<ConcurrentRuns(const std::vector<ModelVariant>&)>;

/// A generation of worlds, drawn from what is known. Those that a guard stopped are left out, and
/// said so; throws SimulationError if too few to learn from are left.
Ensemble run_members(const Gaussian& estimate, unsigned members, const std::string& name,
                     double strain, const RunModels& run);

/// A generation of worlds that go on while a test does.
class GrowingEnsemble {
public:
    GrowingEnsemble(const Gaussian& estimate, unsigned members, const std::string& name,
                    const BeginRuns& begin);
    /// All of them have so many points then. Throws as run_members does.
    void advance_to(std::size_t points);
    std::size_t points() const {
        return ensemble_.runs.empty() ? 0 : ensemble_.runs.front().points.size();
    }
    const Ensemble& members() const { return ensemble_; }
    void save_checkpoint() const { runs_.save_checkpoint(); }

private:
    Ensemble ensemble_;
    ConcurrentRuns runs_;
};

/// A run without stages, of the rocks of another.
ModelRun empty_run_like(const ModelRun& run);
/// Adds the next stage, as worlds foretell it together for the logarithms `at` of the parameters:
/// their regression on their beliefs.
void forecast_stage(ModelRun& sum, const Ensemble& members, const Vector& at);

} // namespace bris

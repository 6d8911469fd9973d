#pragma once

#include "engine/estimation/kalman.hpp"
#include "scenarios/assimilation/model_run.hpp"

#include <functional>
#include <string>
#include <vector>

namespace bris {

/// Logarithms of friction and stiffness, of one or (N x 2) of each of several.
Vector logarithms_of(const RockBelief& rocks);
Matrix logarithms_of(const std::vector<RockBelief>& beliefs);
RockBelief mean_of(const Gaussian& belief);
/// Beliefs of `worlds` worlds, spread evenly over a distribution.
std::vector<RockBelief> beliefs_of_worlds(const Gaussian& belief, unsigned worlds);

/// Worlds that differ in what they believe, and what they foretold.
struct Worlds {
    std::vector<RockBelief> beliefs;
    std::vector<ModelRun> runs;
};

/// The runs of some arms to an axial strain.
using RunModels = std::function<std::vector<ModelRun>(const std::vector<ModelArm>&, double strain)>;

/// Runs of some arms that go on together, as far as they are asked to.
struct RunsAtWork {
    /// Adds to each run until it has so many points (one at the start, one for each stage). One
    /// that a guard stopped says so and is not among those of the next call: the caller drops it,
    /// too.
    std::function<void(std::vector<ModelRun>& runs, std::size_t points)> go_on;
    /// Where they are now, to be taken up from there when the same arms begin anew.
    std::function<void()> keep = [] {};
};
using BeginRuns = std::function<RunsAtWork(const std::vector<ModelArm>&)>;

/// A generation of worlds, drawn from what is known. Those that a guard stopped are left out, and
/// said so; throws SimulationError if too few to learn from are left.
Worlds run_worlds(const Gaussian& belief, unsigned worlds, const std::string& name, double strain,
                  const RunModels& run);

/// A generation of worlds that go on while a test does.
class GrowingWorlds {
public:
    GrowingWorlds(const Gaussian& belief, unsigned worlds, const std::string& name,
                  const BeginRuns& begin);
    /// All of them have so many points then. Throws as run_worlds does.
    void go_on_to(std::size_t points);
    std::size_t points() const {
        return worlds_.runs.empty() ? 0 : worlds_.runs.front().points.size();
    }
    const Worlds& worlds() const { return worlds_; }
    void keep() const { runs_.keep(); }

private:
    Worlds worlds_;
    RunsAtWork runs_;
};

/// A run without stages, of the rocks of another.
ModelRun begun_like(const ModelRun& run);
/// Adds the next stage, as worlds foretell it together for the logarithms `at` of the parameters:
/// their regression on their beliefs.
void foretell(ModelRun& sum, const Worlds& worlds, const Vector& at);

} // namespace bris

#pragma once

#include "engine/options.hpp"
#include "engine/signal/kalman.hpp"
#include "systems/procedure/model_run.hpp"
#include "systems/procedure/recorded_test.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace bris {

/// How friction and stiffness are learned while a test goes on.
struct Learning {
    unsigned worlds = 8;            ///< in each of two generations: drawn from what is known before the test, and after its beginning
    double first_strain = 2e-3;     ///< to which the first generation runs
    double final_strain = 0.01;     ///< to which learning goes on
    double first_window = 1e-4, window = 1e-3; ///< of axial strain, over which q is averaged: half of it, within these
    double friction_deviation = 0.3, stiffness_deviation = 0.4; ///< of their logarithms, before anything is measured
    double specimen_scatter = 0;    ///< by which the real specimen may be stronger or weaker than the model's, of ln q; and by the same share dilate and widen
    double force_noise = 0.01;      ///< of ln q as measured
    bool by_sensors = true;         ///< and not by q alone
    bool by_volume = false;         ///< likewise

    void describe(auto& option);
};

/// The stage of a run nearest to a sample's strain; nothing: it goes not that far. Half a stage is less than sensors tell apart.
std::optional<std::size_t> stage_of_sample(const ModelRun& run, double strain);

/// What was measured in a test: q (Pa) and volumetric strain (NaN: not) by axial strain, in order of strain, and the ways of
/// the sensor rocks, if there are.
struct MeasuredTest {
    std::vector<double> strain, q, volumetric_strain;
    std::vector<SensorWay> ways = {};
    double displacement_noise = 1e-4; ///< m, of them, root mean square
    double lateness = 0;              ///< of strain, by which their samples come late
};
MeasuredTest measured_test(const std::vector<TriaxialPoint>& points);
MeasuredTest measured_test(const RecordedTest& test);

/// Logarithms of friction and stiffness, of one or (N x 2) of each of several.
Vector logarithms_of(const RockBelief& rocks);
Matrix logarithms_of(const std::vector<RockBelief>& beliefs);
RockBelief mean_of(const Gaussian& belief);
/// What is known of them before a test.
Gaussian prior_of(const RockBelief& middle, const Learning& settings);

/// Beliefs of `worlds` worlds, spread evenly over a distribution.
std::vector<RockBelief> beliefs_of_worlds(const Gaussian& belief, unsigned worlds);

/// What is known at an axial strain.
struct KnownAt {
    double strain;
    Gaussian belief;
    double squared_distance; ///< of the last measurement of q from what was expected: chi square of one degree; -1: none in this window
};

/// Worlds that differ in what they believe, and what they foretold.
struct Worlds {
    std::vector<RockBelief> beliefs;
    std::vector<ModelRun> runs;
};

/// Learns window by window up to `final_strain`, from no measurement before its time: from the logarithm of q, from how far
/// the sensor rocks have moved outwards in the mean, and from the volumetric strain, each as far as it is measured and asked for.
std::vector<KnownAt> learn(const Gaussian& prior, const Worlds& worlds, const MeasuredTest& measured, const Learning& settings, double final_strain);

/// Where windows end, up to `final_strain`.
std::vector<double> window_ends(const Learning& settings, double final_strain);

/// The runs of some arms to an axial strain.
using RunModels = std::function<std::vector<ModelRun>(const std::vector<ModelArm>&, double strain)>;

/// A generation of worlds, drawn from what is known. Those that a guard stopped are left out, and said so; throws
/// SimulationError if too few to learn from are left.
Worlds run_worlds(const Gaussian& belief, const Learning& settings, const std::string& name, double strain, const RunModels& run);
/// What the second generation is drawn from: around what was learned, wide enough to show slopes through the chaos.
Gaussian spread_around(const Gaussian& prior, const std::vector<KnownAt>& known);

/// Two generations of worlds, and what is known at the end of each window.
struct Learned {
    Worlds first, second;
    std::vector<KnownAt> known;
};
/// The second generation runs to `strain`.
Learned learn_in_two_generations(const Gaussian& prior, const MeasuredTest& measured, const Learning& settings, double strain, const RunModels& run);

/// What a model is told of it: its beliefs after windows in which one of them changed by more than `change`, relative, and
/// than its deviation.
std::vector<LearnedBelief> schedule_of(const std::vector<KnownAt>& known, const RockBelief& first, double change);

/// A run without stages, of the rocks of another.
ModelRun begun_like(const ModelRun& run);
/// Adds the next stage, as worlds foretell it together for the logarithms `at` of the parameters: their regression on
/// their beliefs.
void foretell(ModelRun& sum, const Worlds& worlds, const Vector& at);
/// What the worlds foretell together for the parameters as they are known at each strain: their regression on their
/// beliefs. Chaos of single worlds averages out; a run cannot know better where its rocks go. Curves and motions only.
ModelRun foretold_by(const Learned& learned, const Gaussian& prior);

void Learning::describe(auto& option) {
    option("worlds", worlds, "", "in each of two generations, that friction and stiffness are learned from", within(6, 1000));
    option("first_strain", first_strain, "", "to which the first generation runs", above(0));
    option("learning_strain", final_strain, "", "to which learning goes on", above(0));
    option("learning_window", window, "", "axial strain over which q is averaged", above(0));
    option("friction_deviation", friction_deviation, "", "of its logarithm, before anything is measured", above(0));
    option("stiffness_deviation", stiffness_deviation, "", "likewise", above(0));
    option("specimen_scatter", specimen_scatter, "", "by which the real specimen may be stronger than the model's for other reasons, of ln q", at_least(0));
    option("force_noise", force_noise, "", "of q as measured, relative", at_least(0));
    option("learn_by_sensors", by_sensors, "", "too, by how far they move outwards, where that was recorded, not by q alone");
    option("learn_by_volume", by_volume, "", "likewise, by the volumetric strain");
}

} // namespace bris

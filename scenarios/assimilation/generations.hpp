#pragma once

#include "scenarios/assimilation/learning.hpp"

#include <vector>

namespace bris {

/// What the second generation is drawn from: around what was learned, wide enough to show slopes
/// through the chaos.
Gaussian spread_around(const Gaussian& prior, const std::vector<EstimateAt>& estimates);

/// Two generations of worlds, and what is known at the end of each window.
struct Learned {
    Ensemble first, second;
    std::vector<EstimateAt> estimates;
};
/// Goes on from a first generation, which is the same whatever is learned; the second one runs to
/// `strain`.
Learned learn_on(const Gaussian& prior, Ensemble first, const MeasuredTest& measured,
                 const Learning& settings, double strain, const RunModels& run);
/// From the beginning.
Learned learn_in_two_generations(const Gaussian& prior, const MeasuredTest& measured,
                                 const Learning& settings, double strain, const RunModels& run);

/// What a model is told of it: its beliefs after windows in which one of them changed by more than
/// `change`, relative, and than its deviation.
std::vector<LearnedParameters> schedule_of(const std::vector<EstimateAt>& estimates,
                                           const RockParameters& first, double change);

/// What the worlds foretell together for the parameters as they are known at each strain: their
/// regression on their beliefs. Chaos of single worlds averages out; a run cannot know better where
/// its rocks go. Curves and motions only.
ModelRun ensemble_forecast(const Learned& learned, const Gaussian& prior);

} // namespace bris

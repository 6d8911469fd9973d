#pragma once

#include "scenarios/assimilation/learning.hpp"

#include <vector>

namespace bris {

/// What the second generation is drawn from: around what was learned, wide enough to show slopes
/// through the chaos.
Gaussian spread_around(const Gaussian& prior, const std::vector<KnownAt>& known);

/// Two generations of worlds, and what is known at the end of each window.
struct Learned {
    Worlds first, second;
    std::vector<KnownAt> known;
};
/// Goes on from a first generation, which is the same whatever is learned; the second one runs to
/// `strain`.
Learned learn_on(const Gaussian& prior, Worlds first, const MeasuredTest& measured,
                 const Learning& settings, double strain, const RunModels& run);
/// From the beginning.
Learned learn_in_two_generations(const Gaussian& prior, const MeasuredTest& measured,
                                 const Learning& settings, double strain, const RunModels& run);

/// What a model is told of it: its beliefs after windows in which one of them changed by more than
/// `change`, relative, and than its deviation.
std::vector<LearnedBelief> schedule_of(const std::vector<KnownAt>& known, const RockBelief& first,
                                       double change);

/// What the worlds foretell together for the parameters as they are known at each strain: their
/// regression on their beliefs. Chaos of single worlds averages out; a run cannot know better where
/// its rocks go. Curves and motions only.
ModelRun foretold_by(const Learned& learned, const Gaussian& prior);

} // namespace bris

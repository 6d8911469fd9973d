#pragma once

#include "scenarios/ensemble/learning.hpp"

#include <vector>

namespace bris {

/// The distribution that the second generation is drawn from: centred on the posterior of the
/// first, but wide enough for the regression to resolve slopes in spite of the divergence of single
/// runs.
Gaussian spread_around(const Gaussian& prior, const std::vector<EstimateAt>& estimates);

/// Two generations of ensemble members, and the parameter estimate at the end of each window.
struct Learned {
    Ensemble first, second;
    std::vector<EstimateAt> estimates;
};
/// Estimates the parameters from a given first generation, which is the same whatever is measured;
/// the second generation runs to `strain`.
Learned learn_on(const Gaussian& prior, Ensemble first, const Measurements& measured,
                 const Learning& settings, double strain, const RunModels& run);
/// Runs both generations and estimates the parameters.
Learned learn_in_two_generations(const Gaussian& prior, const Measurements& measured,
                                 const Learning& settings, double strain, const RunModels& run);

/// The parameters that a single model run is given in the course of a test: the estimates after
/// windows in which one of the parameters changed by more than `change`, relative, and by more than
/// its deviation.
std::vector<LearnedParameters> schedule_of(const std::vector<EstimateAt>& estimates,
                                           const RockParameters& first, double change);

/// The ensemble forecast at each strain, for the parameters as estimated by then: the regression of
/// the members on their parameters. The divergence of single runs averages out, while a single run
/// cannot predict more than its own realisation of the rock motions. Contains curves and motions
/// only.
ModelRun ensemble_forecast(const Learned& learned, const Gaussian& prior);

} // namespace bris

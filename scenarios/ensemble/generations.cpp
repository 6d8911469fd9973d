#include "scenarios/ensemble/generations.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bris {

Gaussian spread_around(const Gaussian& prior, const std::vector<EstimateAt>& estimates) {
    Gaussian around = estimates.empty() ? prior : estimates.back().estimate;
    const Vector deviation = around.root.rowwise().norm(), before = prior.root.rowwise().norm();
    around.root = Matrix((2 * deviation).cwiseMax(0.3 * before).cwiseMin(before).asDiagonal());
    return around;
}

Learned learn_in_two_generations(const Gaussian& prior, const Measurements& measured,
                                 const Learning& settings, double strain, const RunModels& run) {
    return learn_on(prior,
                    run_members(prior, settings.members, "first", settings.first_strain, run),
                    measured, settings, strain, run);
}

Learned learn_on(const Gaussian& prior, Ensemble first, const Measurements& measured,
                 const Learning& settings, double strain, const RunModels& run) {
    Learned learned;
    learned.first = std::move(first);
    learned.estimates = learn(prior, learned.first, measured, settings, settings.first_strain);
    learned.second = run_members(spread_around(prior, learned.estimates), settings.members,
                                 "second", strain, run);
    // the second generation assimilates all measurements from the beginning
    const auto later =
        learn(prior, learned.second, measured, settings, std::min(settings.final_strain, strain));
    std::erase_if(learned.estimates,
                  [&](const EstimateAt& k) { return k.strain >= settings.first_strain - 1e-9; });
    for (const EstimateAt& k : later)
        if (k.strain >= settings.first_strain - 1e-9) learned.estimates.push_back(k);
    return learned;
}

std::vector<LearnedParameters> schedule_of(const std::vector<EstimateAt>& estimates,
                                           const RockParameters& first, double change) {
    std::vector<LearnedParameters> schedule;
    RockParameters last = first;
    for (const EstimateAt& k : estimates) {
        const RockParameters now = mean_of(k.estimate);
        const Matrix covariance = k.estimate.covariance();
        const auto changed = [&](double before, double after, Eigen::Index p) {
            return std::abs(std::log(after / before)) >
                   std::max(change, std::sqrt(covariance(p, p)));
        };
        if (!changed(last.friction, now.friction, 0) && !changed(last.stiffness, now.stiffness, 1))
            continue;
        schedule.push_back({k.strain, now});
        last = now;
    }
    return schedule;
}

ModelRun ensemble_forecast(const Learned& learned, const Gaussian& prior) {
    const ModelRun& like = learned.second.runs.front();
    ModelRun sum = empty_run_like(like);
    for (const ModelRun& run : learned.second.runs) {
        sum.steps += run.steps;
        sum.wall_time += run.wall_time;
    }
    for (std::size_t stage = 0; stage < like.curves.size(); ++stage) {
        const double strain = like.curves[quantity::axial_strain][stage];
        Vector at = prior.mean;
        for (const EstimateAt& k : learned.estimates)
            if (k.strain <= strain + 1e-9) at = k.estimate.mean;
        const bool early = stage < learned.first.runs.front().curves.size() - 1;
        forecast_stage(sum, early ? learned.first : learned.second, at);
    }
    return sum;
}

} // namespace bris

#include "scenarios/assimilation/generations.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bris {

Gaussian spread_around(const Gaussian& prior, const std::vector<KnownAt>& known) {
    Gaussian around = known.empty() ? prior : known.back().belief;
    const Vector deviation = around.root.rowwise().norm(), before = prior.root.rowwise().norm();
    around.root = Matrix((2 * deviation).cwiseMax(0.3 * before).cwiseMin(before).asDiagonal());
    return around;
}

Learned learn_in_two_generations(const Gaussian& prior, const MeasuredTest& measured,
                                 const Learning& settings, double strain, const RunModels& run) {
    return learn_on(prior, run_worlds(prior, settings.worlds, "first", settings.first_strain, run),
                    measured, settings, strain, run);
}

Learned learn_on(const Gaussian& prior, Worlds first, const MeasuredTest& measured,
                 const Learning& settings, double strain, const RunModels& run) {
    Learned learned;
    learned.first = std::move(first);
    learned.known = learn(prior, learned.first, measured, settings, settings.first_strain);
    learned.second =
        run_worlds(spread_around(prior, learned.known), settings.worlds, "second", strain, run);
    const auto later = learn(
        prior, learned.second, measured, settings,
        std::min(settings.final_strain, strain)); // what the first generation saw is seen anew
    std::erase_if(learned.known,
                  [&](const KnownAt& k) { return k.strain >= settings.first_strain - 1e-9; });
    for (const KnownAt& k : later)
        if (k.strain >= settings.first_strain - 1e-9) learned.known.push_back(k);
    return learned;
}

std::vector<LearnedBelief> schedule_of(const std::vector<KnownAt>& known, const RockBelief& first,
                                       double change) {
    std::vector<LearnedBelief> schedule;
    RockBelief last = first;
    for (const KnownAt& k : known) {
        const RockBelief now = mean_of(k.belief);
        const Matrix covariance = k.belief.covariance();
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

ModelRun foretold_by(const Learned& learned, const Gaussian& prior) {
    const ModelRun& like = learned.second.runs.front();
    ModelRun sum = begun_like(like);
    for (const ModelRun& run : learned.second.runs) {
        sum.steps += run.steps;
        sum.wall_time += run.wall_time;
    }
    for (std::size_t stage = 0; stage < like.points.size(); ++stage) {
        const double strain = like.points[stage].axial_strain;
        Vector at = prior.mean;
        for (const KnownAt& k : learned.known)
            if (k.strain <= strain + 1e-9) at = k.belief.mean;
        const bool early = stage < learned.first.runs.front().points.size() - 1;
        foretell(sum, early ? learned.first : learned.second, at);
    }
    return sum;
}

} // namespace bris

#include "systems/procedure/learning.hpp"

#include "engine/errors.hpp"
#include "systems/fusion/parameter_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double no_stress = 1e3; // Pa, below which a logarithm of q says nothing

/// Mean of q over a window of strain; NaN if nothing was measured there.
double mean_q(const MeasuredStress& s, double from, double to) {
    double sum = 0, count = 0;
    for (std::size_t k = 0; k < s.strain.size(); ++k)
        if (s.strain[k] > from + 1e-9 && s.strain[k] <= to + 1e-9) {
            sum += s.q[k];
            ++count;
        }
    return sum / count;
}

Matrix design_of(const std::vector<RockBelief>& beliefs) {
    Matrix design(static_cast<Eigen::Index>(beliefs.size()), 2);
    for (std::size_t j = 0; j < beliefs.size(); ++j) design.row(static_cast<Eigen::Index>(j)) = logarithms_of(beliefs[j]).transpose();
    return design;
}

/// One stage of a run made of those of several: sums with weights.
void add_blend(ModelRun& sum, const Worlds& worlds, const Vector& weights, std::size_t stage) {
    TriaxialPoint point;
    const ModelRun& like = worlds.runs.front();
    point.ring_radius.assign(like.points[stage].ring_radius.size(), 0);
    std::vector<Vec3> displacement(like.rocks.size(), Vec3::Zero()), rotation = displacement;
    for (std::size_t j = 0; j < worlds.runs.size(); ++j) {
        const double w = weights[static_cast<Eigen::Index>(j)];
        const ModelRun& run = worlds.runs[j];
        const TriaxialPoint& p = run.points[stage];
        point.axial_strain += w * p.axial_strain;
        point.volumetric_strain += w * p.volumetric_strain;
        point.deviatoric_stress += w * p.deviatoric_stress;
        for (std::size_t r = 0; r < point.ring_radius.size(); ++r) point.ring_radius[r] += w * p.ring_radius[r];
        for (std::size_t rock = 0; rock < displacement.size(); ++rock) {
            displacement[rock] += w * run.displacement[stage][rock];
            rotation[rock] += w * run.rotation[stage][rock];
        }
    }
    sum.points.push_back(point);
    sum.displacement.push_back(std::move(displacement));
    sum.rotation.push_back(std::move(rotation));
}

} // namespace

MeasuredStress measured_stress(const std::vector<TriaxialPoint>& points) {
    MeasuredStress s;
    for (const TriaxialPoint& p : points) {
        s.strain.push_back(p.axial_strain);
        s.q.push_back(p.deviatoric_stress);
    }
    return s;
}

Vector logarithms_of(const RockBelief& rocks) {
    Vector v(2);
    v << std::log(rocks.friction), std::log(rocks.stiffness);
    return v;
}

RockBelief mean_of(const Gaussian& belief) { return {std::exp(belief.mean[0]), std::exp(belief.mean[1])}; }

Gaussian prior_of(const RockBelief& middle, const Learning& settings) {
    Gaussian prior(2);
    prior.mean = logarithms_of(middle);
    prior.root.diagonal() << settings.friction_deviation, settings.stiffness_deviation;
    return prior;
}

std::vector<RockBelief> beliefs_of_worlds(const Gaussian& belief, unsigned worlds) {
    // multiples of two numbers whose fractions fill the square evenly (Roberts 2018), then as Box and Muller's pairs
    constexpr double g = 1.32471795724474602596;
    std::vector<RockBelief> beliefs;
    for (unsigned k = 1; k <= worlds; ++k) {
        const double u = std::fmod(0.5 + k / g, 1.0), v = std::fmod(0.5 + k / (g * g), 1.0), radius = std::sqrt(-2 * std::log(1 - u));
        const double x = radius * std::cos(2 * pi * v), y = radius * std::sin(2 * pi * v);
        beliefs.push_back({std::exp(belief.mean[0] + belief.root(0, 0) * x), std::exp(belief.mean[1] + belief.root(1, 0) * x + belief.root(1, 1) * y)});
    }
    return beliefs;
}

std::vector<KnownAt> learn(const Gaussian& prior, const Worlds& worlds, const MeasuredStress& measured, const Learning& settings, double final_strain) {
    const auto n = static_cast<Eigen::Index>(worlds.beliefs.size());
    require(worlds.runs.size() == worlds.beliefs.size(), fmt::format("worlds: expected {} runs, found {}", worlds.beliefs.size(), worlds.runs.size()));
    std::vector<MeasuredStress> foretold;
    for (const ModelRun& run : worlds.runs) foretold.push_back(measured_stress(run.points));
    ParameterEstimate estimate(prior, design_of(worlds.beliefs), {{settings.specimen_scatter, settings.force_noise}});
    std::vector<KnownAt> known;
    // narrow windows at first, where stiffness shows, then wide ones
    for (double from = 0, to = 0; to < final_strain - 1e-9; from = to) {
        to = std::min(from + std::clamp(0.5 * from, settings.first_window, settings.window), final_strain);
        const double found = mean_q(measured, from, to);
        bool says_something = found > no_stress;
        Vector q(n);
        for (Eigen::Index j = 0; j < n; ++j) {
            const double world = mean_q(foretold[static_cast<std::size_t>(j)], from, to);
            says_something = says_something && world > no_stress;
            q[j] = std::log(world);
        }
        if (!says_something) continue;
        const double distance = estimate.see(0, q, std::log(found));
        known.push_back({to, estimate.parameters(), distance});
    }
    return known;
}

Learned learn_in_two_generations(const Gaussian& prior, const MeasuredStress& measured, const Learning& settings, double strain,
                                 const std::function<std::vector<ModelRun>(const std::vector<ModelArm>&, double strain)>& run) {
    const auto run_worlds = [&](const Gaussian& belief, const char* name, double to) {
        Worlds worlds{beliefs_of_worlds(belief, settings.worlds), {}};
        std::vector<ModelArm> arms;
        for (const RockBelief& b : worlds.beliefs) arms.push_back({.name = fmt::format("{} world {} of {}", name, arms.size() + 1, settings.worlds), .rocks = b});
        worlds.runs = run(arms, to);
        return worlds;
    };
    Learned learned;
    learned.first = run_worlds(prior, "first", settings.first_strain);
    learned.known = learn(prior, learned.first, measured, settings, settings.first_strain);
    // around what was learned, wide enough to show slopes through the chaos; what the first generation saw is seen anew
    Gaussian around = learned.known.empty() ? prior : learned.known.back().belief;
    const Matrix covariance = around.covariance();
    around.root.setZero();
    for (Eigen::Index p = 0; p < 2; ++p) around.root(p, p) = std::min(prior.root(p, p), std::max(2 * std::sqrt(covariance(p, p)), 0.3 * prior.root(p, p)));
    learned.second = run_worlds(around, "second", strain);
    const auto later = learn(prior, learned.second, measured, settings, std::min(settings.final_strain, strain));
    std::erase_if(learned.known, [&](const KnownAt& k) { return k.strain >= settings.first_strain - 1e-9; });
    for (const KnownAt& k : later)
        if (k.strain >= settings.first_strain - 1e-9) learned.known.push_back(k);
    return learned;
}

std::vector<LearnedBelief> schedule_of(const std::vector<KnownAt>& known, const RockBelief& first, double change) {
    std::vector<LearnedBelief> schedule;
    RockBelief last = first;
    for (const KnownAt& k : known) {
        const RockBelief now = mean_of(k.belief);
        const Matrix covariance = k.belief.covariance();
        const auto changed = [&](double before, double after, Eigen::Index p) { return std::abs(std::log(after / before)) > std::max(change, std::sqrt(covariance(p, p))); };
        if (!changed(last.friction, now.friction, 0) && !changed(last.stiffness, now.stiffness, 1)) continue;
        schedule.push_back({k.strain, now});
        last = now;
    }
    return schedule;
}

ModelRun foretold_by(const Learned& learned, const Gaussian& prior) {
    const ModelRun& like = learned.second.runs.front();
    ModelRun sum;
    sum.rocks = like.rocks;
    sum.sensors = like.sensors;
    sum.start = like.start;
    sum.shell = like.shell;
    for (const ModelRun& run : learned.second.runs) {
        sum.steps += run.steps;
        sum.wall_time += run.wall_time;
    }
    const Matrix first = design_of(learned.first.beliefs), second = design_of(learned.second.beliefs);
    for (std::size_t stage = 0; stage < like.points.size(); ++stage) {
        const double strain = like.points[stage].axial_strain;
        Vector at = prior.mean;
        for (const KnownAt& k : learned.known)
            if (k.strain <= strain + 1e-9) at = k.belief.mean;
        const bool early = stage < learned.first.runs.front().points.size() - 1;
        add_blend(sum, early ? learned.first : learned.second, regression_weights(early ? first : second, at), stage);
    }
    return sum;
}

} // namespace bris

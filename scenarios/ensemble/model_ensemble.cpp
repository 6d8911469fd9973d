#include "scenarios/ensemble/model_ensemble.hpp"

#include "engine/errors.hpp"
#include "engine/estimation/parameter_estimate.hpp"
#include "engine/message.hpp"

#include <fmt/format.h>

#include <cmath>

namespace bris {

namespace {

/// Adds one stage to `sum`: the weighted sum of that stage of all members.
void add_blend(ModelRun& sum, const Ensemble& members, const Vector& weights, std::size_t stage) {
    const ModelRun& like = members.runs.front();
    const auto row = sum.curves.add_row();
    for (const auto& [of, part, values, low, high] : like.curves.columns()) {
        double& blend = row.part(*of, part) = 0;
        for (std::size_t j = 0; j < members.runs.size(); ++j)
            blend += weights[static_cast<Eigen::Index>(j)] *
                     members.runs[j].curves.column(*of, part).values[stage];
    }
    std::vector<Vec3> displacement(like.rocks.size(), Vec3::Zero()), rotation = displacement;
    for (std::size_t j = 0; j < members.runs.size(); ++j) {
        const double w = weights[static_cast<Eigen::Index>(j)];
        const ModelRun& run = members.runs[j];
        for (std::size_t rock = 0; rock < displacement.size(); ++rock) {
            displacement[rock] += w * run.displacement[stage][rock];
            rotation[rock] += w * run.rotation[stage][rock];
        }
    }
    sum.displacement.push_back(std::move(displacement));
    sum.rotation.push_back(std::move(rotation));
}

std::vector<ModelVariant> variants_of(const std::vector<RockParameters>& parameters,
                                      const std::string& name) {
    std::vector<ModelVariant> variants;
    for (const RockParameters& b : parameters)
        variants.push_back({.name = fmt::format("{} member {} of {}", name, variants.size() + 1,
                                                parameters.size()),
                            .rocks = b});
    return variants;
}

void remove_stopped(Ensemble& members) {
    for (std::size_t j = members.runs.size(); j-- > 0;) {
        if (members.runs[j].stopped.empty()) continue;
        say(fmt::format("warning: an ensemble member is left out: {}", members.runs[j].stopped));
        if (members.runs.size() <= ParameterEstimate::fewest_members)
            throw SimulationError(members.runs[j].stopped);
        members.runs.erase(members.runs.begin() + static_cast<std::ptrdiff_t>(j));
        members.parameters.erase(members.parameters.begin() + static_cast<std::ptrdiff_t>(j));
    }
}

} // namespace

Vector logarithms_of(const RockParameters& rocks) {
    Vector v(2);
    v << std::log(rocks.friction), std::log(rocks.stiffness);
    return v;
}

Matrix logarithms_of(const std::vector<RockParameters>& parameters) {
    Matrix logarithms(static_cast<Eigen::Index>(parameters.size()), 2);
    for (std::size_t j = 0; j < parameters.size(); ++j)
        logarithms.row(static_cast<Eigen::Index>(j)) = logarithms_of(parameters[j]).transpose();
    return logarithms;
}

RockParameters mean_of(const Gaussian& estimate) {
    return {std::exp(estimate.mean[0]), std::exp(estimate.mean[1])};
}

std::vector<RockParameters> draw_members(const Gaussian& estimate, unsigned members) {
    // a low-discrepancy sequence in the unit square (Roberts 2018), mapped to normal deviates by
    // the Box-Muller transform
    constexpr double g = 1.32471795724474602596;
    std::vector<RockParameters> parameters;
    for (unsigned k = 1; k <= members; ++k) {
        const double u = std::fmod(0.5 + k / g, 1.0), v = std::fmod(0.5 + k / (g * g), 1.0),
                     radius = std::sqrt(-2 * std::log(1 - u));
        const double x = radius * std::cos(2 * pi * v), y = radius * std::sin(2 * pi * v);
        parameters.push_back(
            {std::exp(estimate.mean[0] + estimate.root(0, 0) * x),
             std::exp(estimate.mean[1] + estimate.root(1, 0) * x + estimate.root(1, 1) * y)});
    }
    return parameters;
}

Ensemble run_members(const Gaussian& estimate, unsigned count, const std::string& name,
                     double strain, const RunModels& run) {
    Ensemble members{draw_members(estimate, count), {}};
    members.runs = run(variants_of(members.parameters, name), strain);
    remove_stopped(members);
    return members;
}

GrowingEnsemble::GrowingEnsemble(const Gaussian& estimate, unsigned count, const std::string& name,
                                 const BeginRuns& begin)
    : ensemble_{draw_members(estimate, count), {}},
      runs_(begin(variants_of(ensemble_.parameters, name))) {}

void GrowingEnsemble::advance_to(std::size_t points) {
    if (points <= this->points()) return;
    runs_.advance(ensemble_.runs, points);
    remove_stopped(ensemble_);
}

ModelRun empty_run_like(const ModelRun& run) {
    ModelRun begun;
    begun.rocks = run.rocks;
    begun.sensors = run.sensors;
    begun.start = run.start;
    begun.shell = run.shell;
    begun.core_porosity = run.core_porosity;
    return begun;
}

void forecast_stage(ModelRun& sum, const Ensemble& members, const Vector& at) {
    add_blend(sum, members, EnsembleRegression(logarithms_of(members.parameters)).weights_at(at),
              sum.curves.size());
}

} // namespace bris

#include "scenarios/assimilation/worlds.hpp"

#include "engine/errors.hpp"
#include "engine/estimation/parameter_estimate.hpp"

#include <fmt/format.h>

#include <cmath>

namespace bris {

namespace {

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
        for (std::size_t r = 0; r < point.ring_radius.size(); ++r)
            point.ring_radius[r] += w * p.ring_radius[r];
        for (std::size_t rock = 0; rock < displacement.size(); ++rock) {
            displacement[rock] += w * run.displacement[stage][rock];
            rotation[rock] += w * run.rotation[stage][rock];
        }
    }
    sum.points.push_back(point);
    sum.displacement.push_back(std::move(displacement));
    sum.rotation.push_back(std::move(rotation));
}

std::vector<ModelArm> arms_of(const std::vector<RockBelief>& beliefs, const std::string& name) {
    std::vector<ModelArm> arms;
    for (const RockBelief& b : beliefs)
        arms.push_back(
            {.name = fmt::format("{} world {} of {}", name, arms.size() + 1, beliefs.size()),
             .rocks = b});
    return arms;
}

void leave_out_stopped(Worlds& worlds) {
    for (std::size_t j = worlds.runs.size(); j-- > 0;) {
        if (worlds.runs[j].stopped.empty()) continue;
        fmt::print("left out: {}\n", worlds.runs[j].stopped);
        if (worlds.runs.size() <= ParameterEstimate::fewest_worlds)
            throw SimulationError(worlds.runs[j].stopped);
        worlds.runs.erase(worlds.runs.begin() + static_cast<std::ptrdiff_t>(j));
        worlds.beliefs.erase(worlds.beliefs.begin() + static_cast<std::ptrdiff_t>(j));
    }
}

} // namespace

Vector logarithms_of(const RockBelief& rocks) {
    Vector v(2);
    v << std::log(rocks.friction), std::log(rocks.stiffness);
    return v;
}

Matrix logarithms_of(const std::vector<RockBelief>& beliefs) {
    Matrix logarithms(static_cast<Eigen::Index>(beliefs.size()), 2);
    for (std::size_t j = 0; j < beliefs.size(); ++j)
        logarithms.row(static_cast<Eigen::Index>(j)) = logarithms_of(beliefs[j]).transpose();
    return logarithms;
}

RockBelief mean_of(const Gaussian& belief) {
    return {std::exp(belief.mean[0]), std::exp(belief.mean[1])};
}

std::vector<RockBelief> beliefs_of_worlds(const Gaussian& belief, unsigned worlds) {
    // multiples of two numbers whose fractions fill the square evenly (Roberts 2018), then as Box
    // and Muller's pairs
    constexpr double g = 1.32471795724474602596;
    std::vector<RockBelief> beliefs;
    for (unsigned k = 1; k <= worlds; ++k) {
        const double u = std::fmod(0.5 + k / g, 1.0), v = std::fmod(0.5 + k / (g * g), 1.0),
                     radius = std::sqrt(-2 * std::log(1 - u));
        const double x = radius * std::cos(2 * pi * v), y = radius * std::sin(2 * pi * v);
        beliefs.push_back(
            {std::exp(belief.mean[0] + belief.root(0, 0) * x),
             std::exp(belief.mean[1] + belief.root(1, 0) * x + belief.root(1, 1) * y)});
    }
    return beliefs;
}

Worlds run_worlds(const Gaussian& belief, unsigned count, const std::string& name, double strain,
                  const RunModels& run) {
    Worlds worlds{beliefs_of_worlds(belief, count), {}};
    worlds.runs = run(arms_of(worlds.beliefs, name), strain);
    leave_out_stopped(worlds);
    return worlds;
}

GrowingWorlds::GrowingWorlds(const Gaussian& belief, unsigned count, const std::string& name,
                             const BeginRuns& begin)
    : worlds_{beliefs_of_worlds(belief, count), {}}, runs_(begin(arms_of(worlds_.beliefs, name))) {}

void GrowingWorlds::go_on_to(std::size_t points) {
    if (points <= this->points()) return;
    runs_.go_on(worlds_.runs, points);
    leave_out_stopped(worlds_);
}

ModelRun begun_like(const ModelRun& run) {
    ModelRun begun;
    begun.rocks = run.rocks;
    begun.sensors = run.sensors;
    begun.start = run.start;
    begun.shell = run.shell;
    begun.core_porosity = run.core_porosity;
    return begun;
}

void foretell(ModelRun& sum, const Worlds& worlds, const Vector& at) {
    add_blend(sum, worlds, WorldRegression(logarithms_of(worlds.beliefs)).weights_at(at),
              sum.points.size());
}

} // namespace bris

#include "scenarios/assimilation/learning_results.hpp"

#include "engine/io/csv.hpp"

#include <fmt/format.h>

#include <cmath>

namespace bris {

std::vector<NamedValue> describe(const Gaussian& belief) {
    const RockBelief mean = mean_of(belief);
    const Matrix covariance = belief.covariance();
    return {{"learned_friction", mean.friction},
            {"learned_friction_deviation", mean.friction * std::sqrt(covariance(0, 0))},
            {"learned_stiffness_ratio", mean.stiffness},
            {"learned_stiffness_ratio_deviation", mean.stiffness * std::sqrt(covariance(1, 1))}};
}

void write_known(const std::filesystem::path& csv, const std::vector<KnownAt>& known) {
    std::vector<std::vector<double>> rows;
    for (const KnownAt& k : known) {
        const RockBelief mean = mean_of(k.belief);
        const Matrix c = k.belief.covariance();
        rows.push_back({k.strain, mean.friction, std::sqrt(c(0, 0)), mean.stiffness,
                        std::sqrt(c(1, 1)), k.squared_distance, static_cast<double>(k.left_out)});
    }
    write_csv(csv,
              {"axial_strain", "friction", "friction_log_deviation", "stiffness_ratio",
               "stiffness_log_deviation", "squared_distance", "q_left_out"},
              rows, {}, 6);
}

void write_worlds(const std::filesystem::path& csv, const Worlds& worlds) {
    std::vector<std::string> names{"axial_strain"}, comments;
    for (const RockBelief& b : worlds.beliefs) {
        names.push_back(fmt::format("q_{}_Pa", names.size()));
        comments.push_back(fmt::format("world {}: friction {:.4g}, stiffness {:.4g}",
                                       comments.size() + 1, b.friction, b.stiffness));
    }
    std::vector<std::vector<double>> rows;
    for (std::size_t k = 0; k < worlds.runs.front().points.size(); ++k) {
        rows.push_back({worlds.runs.front().points[k].axial_strain});
        for (const ModelRun& run : worlds.runs)
            rows.back().push_back(run.points[k].deviatoric_stress);
    }
    write_csv(csv, names, rows, comments, 7);
}

} // namespace bris

#include "scenarios/ensemble/learning_results.hpp"

#include "engine/io/csv.hpp"

#include <fmt/format.h>

#include <cmath>

namespace bris {

std::vector<NamedValue> named_values_of(const Gaussian& estimate) {
    const RockParameters mean = mean_of(estimate);
    const Matrix covariance = estimate.covariance();
    return {{"learned_friction", mean.friction},
            {"learned_friction_deviation", mean.friction * std::sqrt(covariance(0, 0))},
            {"learned_stiffness_ratio", mean.stiffness},
            {"learned_stiffness_ratio_deviation", mean.stiffness * std::sqrt(covariance(1, 1))}};
}

void write_estimates(const std::filesystem::path& csv, const std::vector<EstimateAt>& estimates) {
    std::vector<std::vector<double>> rows;
    for (const EstimateAt& k : estimates) {
        const RockParameters mean = mean_of(k.estimate);
        const Matrix c = k.estimate.covariance();
        rows.push_back({k.strain, mean.friction, std::sqrt(c(0, 0)), mean.stiffness,
                        std::sqrt(c(1, 1)), k.normalised_innovation_squared,
                        static_cast<double>(k.rejected)});
    }
    write_csv(csv,
              {"axial_strain", "friction", "friction_log_deviation", "stiffness_ratio",
               "stiffness_log_deviation", "normalised_innovation_squared", "q_rejected"},
              rows, {}, 6);
}

void write_members(const std::filesystem::path& csv, const Ensemble& members) {
    std::vector<std::string> names{"axial_strain"}, comments;
    for (const RockParameters& b : members.parameters) {
        names.push_back(fmt::format("q_{}_Pa", names.size()));
        comments.push_back(fmt::format("member {}: friction {:.4g}, stiffness {:.4g}",
                                       comments.size() + 1, b.friction, b.stiffness));
    }
    std::vector<std::vector<double>> rows;
    for (std::size_t k = 0; k < members.runs.front().curves.size(); ++k) {
        rows.push_back({members.runs.front().curves[quantity::axial_strain][k]});
        for (const ModelRun& run : members.runs)
            rows.back().push_back(run.curves[quantity::deviatoric_stress][k]);
    }
    write_csv(csv, names, rows, comments, 7);
}

} // namespace bris

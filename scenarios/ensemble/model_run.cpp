#include "scenarios/ensemble/model_run.hpp"

#include "scenarios/ensemble/variant_run.hpp"
#include "scenarios/triaxial/triaxial_results.hpp"

#include <limits>

namespace bris {

ModelRun run_model(const TriaxialScene& scene, const TriaxialSettings& settings,
                   const Archive& specimen, const ModelVariant& variant, const ModelWatch& watch,
                   CheckpointedRun* checkpoint) {
    VariantRun run(scene, settings, specimen, variant, watch, checkpoint);
    run.advance_to(std::numeric_limits<std::size_t>::max());
    return std::move(run).take();
}

std::optional<std::size_t> stage_of_sample(const ModelRun& run, double strain) {
    if (run.curves.size() < 2) return {};
    const std::vector<double>& strains = run.curves[quantity::axial_strain];
    return MonotonicStage(run.curves).nearest(strain, 0.501 * (strains[1] - strains[0]));
}

} // namespace bris

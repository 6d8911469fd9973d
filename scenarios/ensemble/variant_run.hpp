#pragma once

#include "engine/stopwatch.hpp"
#include "scenarios/ensemble/checkpointed_run.hpp"
#include "scenarios/ensemble/model_run.hpp"
#include "scenarios/ensemble/triaxial_model.hpp"

#include <cstdint>
#include <memory>

namespace bris {

/// A run of one variant that advances stage by stage as requested, on one thread at a time; a
/// checkpoint can be saved between any two blocks of steps. Scene, settings, specimen and
/// `checkpoint` (may be null) have to outlive it.
class VariantRun {
public:
    /// Resumes from its checkpoint if there is one; runs no step yet.
    VariantRun(const TriaxialScene& scene, const TriaxialSettings& settings,
               const Archive& specimen, ModelVariant variant, ModelWatch watch = {},
               CheckpointedRun* checkpoint = nullptr);

    /// Advances until the run has so many points, or to the end of the test; a resumed run may have
    /// more already. Throws SimulationError, and Interrupted after saving a checkpoint.
    void advance_to(std::size_t points);
    const ModelRun& run() const { return run_; }
    ModelRun take() && { return std::move(run_); }
    const ModelVariant& variant() const { return variant_; }
    /// Saves the present state as a checkpoint; does nothing without one.
    void save_checkpoint();

private:
    bool resume();
    bool advance();
    PhaseProgress progress() const;
    void stage();
    void end();

    const TriaxialScene& scene_;
    const TriaxialSettings& settings_;
    const Archive& specimen_;
    ModelVariant variant_;
    ModelWatch watch_;
    CheckpointedRun* checkpoint_;
    Instant began_ = this_instant();
    double wall_before_ = 0;
    ModelRun run_;
    std::unique_ptr<TriaxialModel> model_;
    std::size_t applied_ = 0; // number of learned parameters applied so far
    bool done_ = false;
};

} // namespace bris

#pragma once

#include "engine/stopwatch.hpp"
#include "scenarios/assimilation/checkpointed_run.hpp"
#include "scenarios/assimilation/model_run.hpp"
#include "scenarios/assimilation/triaxial_model.hpp"

#include <cstdint>
#include <memory>

namespace bris {

/// A run of one arm that goes on as far as it is asked to, on one thread at a time; it can be kept
/// between any two blocks of steps. Scene, settings and specimen have to outlive it, and
/// `checkpoint`, which may be null.
class VariantRun {
public:
    /// Takes up what was kept of it; nothing is run yet.
    VariantRun(const TriaxialScene& scene, const TriaxialSettings& settings,
               const Archive& specimen, ModelVariant variant, std::uint64_t seed,
               ModelWatch watch = {}, CheckpointedRun* checkpoint = nullptr);

    /// Goes on until it has so many points, or to the end of the test; one that was taken up may
    /// have more. Throws Interrupted, what was done being kept, and SimulationError.
    void advance_to(std::size_t points);
    const ModelRun& run() const { return run_; }
    ModelRun take() && { return std::move(run_); }
    const ModelVariant& variant() const { return variant_; }
    /// Where it is now, to be taken up from there. Nothing, if it is kept nowhere.
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
    std::uint64_t seed_;
    ModelWatch watch_;
    CheckpointedRun* checkpoint_;
    Instant began_ = this_instant();
    double wall_before_ = 0;
    ModelRun run_;
    std::unique_ptr<TriaxialModel> model_;
    std::size_t applied_ = 0; // of what was learned
    bool done_ = false;
};

} // namespace bris

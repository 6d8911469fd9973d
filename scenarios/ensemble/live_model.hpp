#pragma once

#include "scenarios/ensemble/analysis.hpp"
#include "scenarios/ensemble/fused_stress.hpp"
#include "scenarios/ensemble/learning.hpp"

#include <optional>
#include <vector>

namespace bris {

/// Settings of a model that follows a test.
struct LiveModelSettings {
    RockParameters before; ///< mean of the prior
    Learning learning = {};
    double stage_strain = 1e-4;
    double final_strain = 0.025;
    /// Stages that the second generation advances for each stage of the test until it has caught
    /// up; at least 2.
    unsigned catch_up = 3;
};

/// Forecast and analysis of a specimen while its test goes on. An ensemble with different friction
/// and stiffness runs along with the test, the measurements update the parameter estimate, and the
/// observations of the sensors correct the rock motions. Members never run ahead of the stage that
/// the test is in, except for the beginning of the first generation. The results depend only on the
/// members, the records and counts of stages, never on the time at which a record arrives.
class LiveModel {
public:
    /// Runs the first generation to the first strain of the learning, which needs no record.
    /// Throws as run_members does.
    LiveModel(const LiveModelSettings& settings, BeginRuns begin);

    /// Computes the next stage from the records of the test so far; the first call is for the
    /// start. At the first strain of the learning a second generation begins, which replaces the
    /// first from the stage at which it has caught up. If guards stop too many of its members
    /// before, this is reported once and the first generation continues to provide the forecast.
    /// Throws SimulationError if that happens later.
    void next_stage(const RecordedTest& so_far);
    /// Advances the members to the next stage before its records arrive; otherwise next_stage does
    /// it.
    void advance_members();
    /// Saves checkpoints of all members at their present states.
    void save_checkpoint() const;

    /// The analysis, stage by stage: motions of all rocks, corrected by the sensors; curves as
    /// forecast with the parameter estimate of that stage.
    const ModelRun& state() const { return state_; }
    /// The forecast of the ensemble alone.
    const ModelRun& forecast() const { return forecast_; }
    const std::vector<EstimateAt>& estimates() const { return estimates_; }
    /// q of the last stage as expected from the records before it, and whether its record agrees.
    const FusedStress& fused() const { return fused_; }
    Gaussian estimate() const { return estimates_.empty() ? prior_ : estimates_.back().estimate; }
    double strain() const { return state_.curves[quantity::axial_strain].back(); }
    /// Axial strain of the stage that next_stage will compute.
    double next_strain() const {
        return static_cast<double>(state_.curves.size()) * settings_.stage_strain;
    }
    bool done() const {
        return next_strain() > settings_.final_strain + 0.5 * settings_.stage_strain;
    }
    /// Axial strain from which the second generation provides the forecast; 0: not yet.
    double caught_up_at() const { return caught_up_at_; }
    /// Axial strain at which too few members of the second generation were left; 0: never.
    double lost_second_at() const { return lost_second_at_; }

private:
    struct Generation {
        Generation(const Gaussian& estimate, const Learning& settings, double stage_strain,
                   const std::string& name, const BeginRuns& begin);
        void advance_to(std::size_t points);
        GrowingEnsemble ensemble;
        GrowingScatter scatter;
    };
    enum class Due { at_window_ends, now };
    void learn_at(double strain, const RecordedTest& so_far, Due due);
    bool second_is_due() const;
    void catch_up_to(std::size_t points);

    LiveModelSettings settings_;
    BeginRuns begin_;
    Gaussian prior_;
    std::optional<Generation> answering_, catching_up_;
    std::optional<Generation> retired_; // until its checkpoints are saved
    std::size_t second_begun_ = 0;      // stages computed by then
    double caught_up_at_ = 0, lost_second_at_ = 0;
    std::vector<EstimateAt> estimates_;
    ModelRun forecast_, state_;
    FusedStress fused_;
};

} // namespace bris

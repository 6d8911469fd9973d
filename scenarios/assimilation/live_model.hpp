#pragma once

#include "scenarios/assimilation/analysis.hpp"
#include "scenarios/assimilation/learning.hpp"

#include <optional>
#include <vector>

namespace bris {

/// How a model follows a test.
struct LiveModelSettings {
    RockParameters before; ///< what is believed before anything is measured
    Learning learning = {};
    double stage_strain = 1e-4;
    double final_strain = 0.025;
    unsigned catch_up = 3; ///< stages that the second generation goes on for each one of the test,
                           ///< until it has caught up; at least 2
};

/// What is known of a specimen while its test goes on: worlds of other frictions and stiffnesses go
/// along with it, what is measured says which of them to believe, and the sensors' records correct
/// where the rocks are. Worlds never run beyond the stage that the test is in, but for the first of
/// the first generation. All of it follows from the worlds and the records, whenever they came, and
/// from counts of stages, never from time.
class LiveModel {
public:
    /// Runs the first generation of worlds to the first strain of the learning: no record is needed
    /// for it. Throws as run_members does.
    LiveModel(const LiveModelSettings& settings, BeginRuns begin);

    /// The next stage, by a test's records so far; the first call is for the start. At the first
    /// strain of the learning a second generation begins, which answers from the stage on to which
    /// it has caught up. Should guards stop too many of its worlds before, that is said once, and
    /// the first one goes on answering; later, that ends the test: SimulationError.
    void next_stage(const RecordedTest& so_far);
    /// What the next stage needs of the worlds, so that its records find it done; else next_stage
    /// does it.
    void advance_members();
    /// All worlds, where they are now.
    void save_checkpoint() const;

    /// Stage by stage: motions of all rocks, corrected by the sensors; curves as foretold with what
    /// was known then.
    const ModelRun& state() const { return state_; }
    /// What the worlds alone said.
    const ModelRun& forecast() const { return forecast_; }
    const std::vector<EstimateAt>& estimates() const { return estimates_; }
    Gaussian estimate() const { return estimates_.empty() ? prior_ : estimates_.back().estimate; }
    double strain() const { return state_.points.back().axial_strain; }
    /// Axial strain of the stage that next_stage will be for.
    double next_strain() const {
        return static_cast<double>(state_.points.size()) * settings_.stage_strain;
    }
    bool done() const {
        return next_strain() > settings_.final_strain + 0.5 * settings_.stage_strain;
    }
    /// From which on the second generation answers; 0: not yet.
    double caught_up_at() const { return caught_up_at_; }
    /// At which too few of its worlds were left; 0: never.
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
    std::optional<Generation> retired_; // until it is kept
    std::size_t second_begun_ = 0;      // stages answered then
    double caught_up_at_ = 0, lost_second_at_ = 0;
    std::vector<EstimateAt> estimates_;
    ModelRun forecast_, state_;
};

} // namespace bris

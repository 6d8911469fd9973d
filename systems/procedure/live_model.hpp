#pragma once

#include "systems/procedure/analysis.hpp"
#include "systems/procedure/learning.hpp"

#include <vector>

namespace bris {

/// What is known of a specimen while its test goes on: worlds of other frictions and stiffnesses run ahead of it, what is
/// measured says which of them to believe, and the sensors' records correct where the rocks are. All of it follows from
/// the worlds and the records, whenever they came.
class LiveModel {
public:
    /// Runs the first generation of worlds: no record is needed for it.
    LiveModel(const RockBelief& before, const Learning& settings, double stage_strain, double final_strain, RunModels run);

    /// The next stage, by a test's records so far; the first call is for the start. At the end of the first generation the
    /// second one runs, to the end of the test.
    void next_stage(const RecordedTest& so_far);

    /// Stage by stage: motions of all rocks, corrected by the sensors; curves as foretold with what was known then.
    const ModelRun& state() const { return state_; }
    /// What the worlds alone said.
    const ModelRun& forecast() const { return forecast_; }
    const std::vector<KnownAt>& known() const { return known_; }
    Gaussian belief() const { return known_.empty() ? prior_ : known_.back().belief; }
    double strain() const { return state_.points.back().axial_strain; }
    /// Axial strain of the stage that next_stage will be for.
    double next_strain() const { return static_cast<double>(state_.points.size()) * stage_strain_; }
    bool done() const { return next_strain() > final_strain_ + 0.5 * stage_strain_; }

private:
    bool second_is_due() const;
    void learn_at(double strain, const RecordedTest& so_far);

    Learning settings_;
    double stage_strain_, final_strain_;
    RunModels run_;
    Gaussian prior_;
    Worlds first_, second_;
    RockScatter scatter_;
    std::vector<KnownAt> known_;
    ModelRun forecast_, state_;
};

} // namespace bris

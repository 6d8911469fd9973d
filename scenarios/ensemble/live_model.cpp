#include "scenarios/ensemble/live_model.hpp"

#include "engine/errors.hpp"
#include "engine/message.hpp"
#include "scenarios/ensemble/generations.hpp"
#include "scenarios/ensemble/twin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace bris {

namespace {

std::size_t stages_to(double strain, double stage_strain) {
    return static_cast<std::size_t>(std::llround(strain / stage_strain));
}

} // namespace

LiveModel::Generation::Generation(const Gaussian& estimate, const Learning& settings,
                                  double stage_strain, const std::string& name,
                                  const BeginRuns& begin)
    : ensemble(estimate, settings.members, name, begin),
      scatter(std::max<std::size_t>(1, stages_to(settings.first_strain, stage_strain) / 10)) {}

void LiveModel::Generation::advance_to(std::size_t points) {
    ensemble.advance_to(points);
    scatter.add(ensemble.members());
}

LiveModel::LiveModel(const LiveModelSettings& settings, BeginRuns begin)
    : settings_(settings), begin_(std::move(begin)),
      prior_(prior_of(settings.before, settings.learning)) {
    answering_.emplace(prior_, settings_.learning, settings_.stage_strain, "first", begin_);
    answering_->advance_to(
        1 + stages_to(std::min(settings_.learning.first_strain, settings_.final_strain),
                      settings_.stage_strain));
    forecast_ = state_ = empty_run_like(answering_->ensemble.members().runs.front());
}

/// Updates the estimate once for each window that ends with this stage, from all records of this
/// window and of earlier ones that have arrived: late records are included from then on.
void LiveModel::learn_at(double strain, const RecordedTest& so_far, Due due) {
    const auto ends = window_ends(settings_.learning, settings_.learning.final_strain);
    const auto passed = std::ranges::find_if(ends.rbegin(), ends.rend(), [&](double end) {
        return end <= strain + 0.5 * settings_.stage_strain;
    });
    if (passed == ends.rend() ||
        (due == Due::at_window_ends && *passed <= strain - 0.5 * settings_.stage_strain))
        return;
    const auto all = learn(prior_, answering_->ensemble.members(), so_far, settings_.learning,
                           std::min(*passed, strain));
    if (all.empty()) return;
    estimates_.push_back(all.back());
    estimates_.back().strain = strain;
}

bool LiveModel::second_is_due() const {
    const double first = settings_.learning.first_strain;
    return !catching_up_ && caught_up_at_ == 0 && lost_second_at_ == 0 &&
           first < settings_.final_strain &&
           state_.curves.size() >= stages_to(first, settings_.stage_strain);
}

void LiveModel::next_stage(const RecordedTest& so_far) {
    advance_members();
    const double strain = next_strain();
    const std::size_t stage = state_.curves.size();
    const bool caught_up = catching_up_ && catching_up_->ensemble.points() > stage;
    if (caught_up) {
        retired_ = std::exchange(answering_, std::exchange(catching_up_, {}));
        caught_up_at_ = strain;
    }
    if (stage > 0) { // before the parameters are learned from this stage's record
        fused_ = fused_stress(answering_->ensemble.members(), estimate(), so_far.curves,
                              settings_.learning, stage);
        learn_at(strain, so_far, caught_up ? Due::now : Due::at_window_ends);
    }
    if (second_is_due()) {
        second_begun_ = stage;
        catching_up_.emplace(spread_around(prior_, estimates_), settings_.learning,
                             settings_.stage_strain, "second", begin_);
    }
    forecast_stage(forecast_, answering_->ensemble.members(), estimate().mean);
    state_.curves.add_row_of(forecast_.curves, stage);
    state_.displacement.push_back(forecast_.displacement.back());
    state_.rotation.push_back(forecast_.rotation.back());
    const SensorInfo& info = so_far.recordings.front().info;
    if (stage > 0)
        compute_analysis_stage(state_, forecast_, answering_->scatter.scatter(),
                               {sensor_rocks(forecast_), so_far.trajectories,
                                info.displacement_noise, info.attitude_noise},
                               stage);
}

void LiveModel::advance_members() {
    if (done()) return;
    if (retired_) { // saved only now, so as not to delay the answer
        retired_->ensemble.save_checkpoint();
        retired_.reset();
    }
    const std::size_t needed = state_.curves.size() + 1;
    answering_->advance_to(needed);
    if (catching_up_)
        catch_up_to(std::min(needed, settings_.catch_up * (state_.curves.size() - second_begun_)));
}

/// If too few members remain, the test goes on with the first generation.
void LiveModel::catch_up_to(std::size_t points) {
    try {
        catching_up_->advance_to(points);
    } catch (const SimulationError&) { // the members that were stopped are reported already
        lost_second_at_ = next_strain();
        say(fmt::format("warning: too few members of the second generation are left at {:.2f} % of "
                        "axial strain: the first generation continues to provide the forecast",
                        100 * lost_second_at_));
        retired_ = std::exchange(catching_up_, {});
    }
}

void LiveModel::save_checkpoint() const {
    for (const auto* generation : {&answering_, &catching_up_, &retired_})
        if (*generation) (*generation)->ensemble.save_checkpoint();
}

} // namespace bris

#include "systems/procedure/live_model.hpp"

#include "systems/procedure/generations.hpp"
#include "systems/procedure/twin.hpp"

#include <algorithm>

namespace bris {

LiveModel::LiveModel(const RockBelief& before, const Learning& settings, double stage_strain, double final_strain, RunModels run)
    : settings_(settings), stage_strain_(stage_strain), final_strain_(final_strain), run_(std::move(run)), prior_(prior_of(before, settings)),
      first_(run_worlds(prior_, settings.worlds, "first", std::min(settings.first_strain, final_strain), run_)), scatter_(scatter_of(first_)),
      forecast_(begun_like(first_.runs.front())), state_(forecast_) {}

bool LiveModel::second_is_due() const { return second_.runs.empty() && state_.points.size() + 1 >= first_.runs.front().points.size() && settings_.first_strain < final_strain_; }

/// Once for each window that ends with this stage, from all that has come of it and of those before: what came late counts from now on.
void LiveModel::learn_at(double strain, const RecordedTest& so_far) {
    const auto ends = window_ends(settings_, settings_.final_strain);
    const auto passed = std::ranges::find_if(ends.rbegin(), ends.rend(), [&](double end) { return end <= strain + 0.5 * stage_strain_; });
    if (passed == ends.rend() || *passed <= strain - 0.5 * stage_strain_) return;
    const auto all = learn(prior_, second_.runs.empty() ? first_ : second_, measured_test(so_far), settings_, std::min(*passed, strain));
    if (all.empty()) return;
    if (!known_.empty() && known_.back().strain == strain) known_.pop_back(); // by the first generation
    known_.push_back(all.back());
    known_.back().strain = strain;
}

void LiveModel::next_stage(const RecordedTest& so_far) {
    const double strain = next_strain();
    const std::size_t stage = state_.points.size();
    if (stage > 0) learn_at(strain, so_far);
    if (second_is_due()) {
        second_ = run_worlds(spread_around(prior_, known_), settings_.worlds, "second", final_strain_, run_);
        scatter_ = scatter_of(second_);
        if (stage > 0) learn_at(strain, so_far);
    }
    foretell(forecast_, second_.runs.empty() ? first_ : second_, belief().mean);
    state_.points.push_back(forecast_.points.back());
    state_.displacement.push_back(forecast_.displacement.back());
    state_.rotation.push_back(forecast_.rotation.back());
    const SensorInfo& info = so_far.recordings.front().info;
    if (stage > 0) analyse_stage(state_, forecast_, scatter_, {sensor_rocks(forecast_), so_far.ways, info.displacement_noise, info.attitude_noise}, stage);
}

} // namespace bris

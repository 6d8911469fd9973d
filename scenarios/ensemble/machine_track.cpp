#include "scenarios/ensemble/machine_track.hpp"

#include "engine/signal/median.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace bris {

namespace {

constexpr std::size_t steps_of_pace = 9, fewest_steps = 3;

double strain_of(const StreamRecord& record) { return record.number("axial_strain"); }

} // namespace

double MachineTrack::time_of(const StreamRecord& record) {
    by_t_ = by_t_ || std::isfinite(record.number("t"));
    return by_t_ ? record.number("t") : record.arrival;
}

MachineTrack::Decision MachineTrack::take(const StreamRecord& record) {
    const double strain = strain_of(record), time = time_of(record);
    if (!(strain > reached_ + allowed(time))) {
        held_.clear();
        if (strain > reached_ || !begun_) advance_to(strain, time);
        return {.used = {record}};
    }
    if (!is_possible(strain, time)) return {.is_ahead = true};
    if (!held_.empty()) {
        const double ahead = strain - strain_of(held_.back());
        const bool is_later = !(time <= time_of(held_.back())); // also without times
        if (ahead == 0) return {.is_ahead = true};              // a copy
        if (!(ahead > 0 && ahead <= largest_jump && is_later)) held_.clear();
    }
    held_.push_back(record);
    if (held_.size() < agreeing) return {.is_ahead = true};
    for (const StreamRecord& one : held_) advance_to(strain_of(one), time_of(one));
    return {.used = std::exchange(held_, {}), .is_gap = true};
}

/// How far ahead a record of this time may be without others that agree with it.
double MachineTrack::allowed(double time) const {
    if (steps_.size() < fewest_steps) return largest_jump;
    std::vector<double> strains, rates;
    for (const Step& step : steps_) {
        strains.push_back(step.strain);
        if (step.seconds > 0) rates.push_back(step.strain / step.seconds);
    }
    double travelled = median(std::move(strains));
    if (rates.size() >= fewest_steps && time > time_)
        travelled = std::max(travelled, (time - time_) * median(std::move(rates)));
    return std::min(largest_jump, faster * travelled);
}

/// Whether the machine can have travelled so far.
bool MachineTrack::is_possible(double strain, double time) const {
    std::vector<double> rates;
    for (const Step& step : steps_)
        if (step.seconds > 0) rates.push_back(step.strain / step.seconds);
    const bool is_known = rates.size() >= fewest_steps && time > time_; // else its clock was set
    if (strain <= reached_ + largest_jump || !is_known) return true;
    return strain - reached_ <= largest_jump + faster * median(std::move(rates)) * (time - time_);
}

void MachineTrack::advance_to(double strain, double time) {
    if (begun_ && strain > reached_) steps_.push_back({strain - reached_, time - time_});
    if (steps_.size() > steps_of_pace) steps_.pop_front();
    begun_ = true;
    reached_ = std::max(reached_, strain);
    time_ = time;
}

} // namespace bris

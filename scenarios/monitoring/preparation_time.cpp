#include "scenarios/monitoring/preparation_time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace bris {

namespace {

// of the processor time of a preparation, of the example's specimen with six members
constexpr std::array<double, 6> shares{0.01, 0.21, 0.59, 0.03, 0.03, 0.13};
constexpr double on_time = 0.8; // of a part of unknown length: what follows may take longer
constexpr double least_done = 2e-3, tell_interval = 0.2; // -, s

} // namespace

void PreparationTime::specimen_reached(const PhaseProgress& now) {
    const std::lock_guard lock(mutex_);
    Part part = vibration;
    if (now.phase == "filling")
        part = filling;
    else if (now.status.starts_with("trial"))
        part = trial;
    else if (now.fraction >= 0)
        part = compression;
    reach(part, now.fraction, "making the specimen: " + now.phase + ", " + now.status);
}

void PreparationTime::member_reached(std::size_t member, const PhaseProgress& now) {
    const std::lock_guard lock(mutex_);
    if (member >= members_.size()) return;
    const bool shears = now.phase.ends_with("shear");
    members_[member] = shears ? std::min(1.0, std::max(1e-9, now.fraction / first_share_)) : 0;
    const bool all_shear = std::ranges::none_of(members_, [](double x) { return x == 0; });
    reach(all_shear || part_ == first_stages ? first_stages : consolidation,
          all_shear ? std::accumulate(members_.begin(), members_.end(), 0.0) /
                          static_cast<double>(members_.size())
                    : -1,
          fmt::format("preparing {} ensemble members: {}, {}", members_.size(), now.phase,
                      now.status));
}

void PreparationTime::end() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
}

void PreparationTime::reach(Part part, double fraction, const std::string& doing) {
    if (part > part_) { // a specimen that is made looser again does not go back
        done_ += shares[part_];
        part_ = part;
        part_began_ = this_instant();
        fraction_ = 0;
    }
    if (part == part_) fraction_ = std::max(fraction_, std::min(1.0, fraction));
    if (ended_ || seconds_since(told_) < tell_interval) return;
    told_ = this_instant();
    tell_(doing, left());
}

/// By the rate of what is done so far. A part of unknown length is taken to last as long as its
/// share says, and approaches its end when it lasts longer.
double PreparationTime::left() const {
    const double elapsed = seconds_since(began_), in_part = seconds_since(part_began_);
    double fraction = fraction_;
    if (fraction <= 0 && done_ > 0 && elapsed > in_part) {
        const double expected = (elapsed - in_part) * shares[part_] / done_,
                     share = in_part / expected;
        fraction = share < on_time
                       ? share
                       : 1 - (1 - on_time) * std::exp(-(share - on_time) / (1 - on_time));
    }
    const double done = done_ + shares[part_] * fraction,
                 later = std::accumulate(shares.begin() + part_ + 1, shares.end(), 0.0);
    if (done < least_done) return std::numeric_limits<double>::quiet_NaN();
    return elapsed / done * (later + shares[part_] * (1 - fraction));
}

} // namespace bris

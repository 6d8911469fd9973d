#include "scenarios/monitoring/preparation_time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace bris {

namespace {

// of the time of a preparation: of the example's specimen without taps, with six members
constexpr std::array<double, 5> shares{0.10, 0.30, 0.10, 0.20, 0.30};
constexpr double least_done = 2e-3, tell_interval = 0.2; // -, s

} // namespace

void PreparationTime::specimen_reached(const PhaseProgress& now) {
    const std::lock_guard lock(mutex_);
    const Part part = now.phase == "filling"                              ? filling
                      : now.status.starts_with("trial") || part_ == trial ? trial
                                                                          : compression;
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
    if (part != part_) {
        part_ = part;
        part_began_ = this_instant();
        fraction_ = 0;
    }
    fraction_ = std::max(fraction_, std::min(1.0, fraction));
    if (ended_ || seconds_since(told_) < tell_interval) return;
    told_ = this_instant();
    tell_(doing, left());
}

/// By the rate of what is done so far. A part whose length is unknown approaches its end.
double PreparationTime::left() const {
    const double before = std::accumulate(shares.begin(), shares.begin() + part_, 0.0),
                 elapsed = seconds_since(began_), in_part = seconds_since(part_began_);
    double fraction = fraction_;
    if (fraction <= 0 && before > 0) {
        const double expected = shares[part_] / before * (elapsed - in_part);
        fraction = expected > 0 ? in_part / (in_part + expected) : 0;
    }
    const double done = before + shares[part_] * fraction;
    return done < least_done ? std::numeric_limits<double>::quiet_NaN()
                             : elapsed * (1 - done) / done;
}

} // namespace bris

#pragma once

#include "engine/progress.hpp"
#include "engine/stopwatch.hpp"

#include <array>
#include <cstddef>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace bris {

/// How far the preparation of a live model is, and the time until it is ready: the time that its
/// finished parts have taken is put in relation to their shares of a whole preparation, as measured
/// once (tests/performance/results/forecast.md). So the estimate follows the speed of the
/// computer, but a specimen that behaves differently makes it wrong. Any thread may call any
/// member.
class PreparationTime {
public:
    /// `tell`: what is done, and the time (s) until the model is ready; NaN: not known yet.
    using Tell = std::function<void(const std::string& doing, double left)>;
    /// `members`: of the first generation, which run to the axial strain `first_strain` of
    /// `final_strain`.
    PreparationTime(Tell tell, std::size_t members, double first_strain, double final_strain)
        : tell_(std::move(tell)), first_share_(first_strain / final_strain), members_(members) {}

    void specimen_reached(const PhaseProgress& now);
    void member_reached(std::size_t member, const PhaseProgress& now);
    /// Nothing more is told: the model is ready.
    void end();

private:
    enum Part : std::size_t {
        filling,
        compression,
        vibration, ///< or taps; a loose specimen needs none
        trial,
        consolidation,
        first_stages
    };
    void reach(Part part, double fraction, const std::string& doing);
    double left() const;

    Tell tell_;
    double first_share_;
    std::mutex mutex_; // of all below
    std::vector<double> members_;
    Instant began_ = this_instant(), told_ = {};
    Part part_ = filling;
    Instant part_began_ = began_;
    double fraction_ = 0; // of the part
    double done_ = 0;     // sum of the shares of the parts before it that were needed
    bool ended_ = false;
};

} // namespace bris

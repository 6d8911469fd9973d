#pragma once

#include "scenarios/track/stretch.hpp"

#include <cstdint>
#include <vector>

namespace bris {

/// How the bed of a tie settles where no ballast is computed: an axle lowers that of tie i by
/// A r_i (R_i / R0)^m, where R_i is the largest force of the bed on the tie as the axle passes, R0
/// that on an even track, and A what a good tie of an even track settles.
struct SettlementLaw {
    double ratio = 2;      ///< r of mud ties: settlement over that of good ones
    double exponent = 2.5; ///< m
    double scatter = 0.5;  ///< standard deviation of ln r_i from tie to tie, also without mud

    /// r_i of each tie. The random numbers follow from `number`.
    std::vector<double> rates(const StretchSettings& stretch, std::uint64_t number) const;
};

/// A stretch of track whose ties settle at different rates by the law alone. So time is counted in
/// the settlement of a good track.
struct SettlingTrack {
    StretchSettings stretch = {};
    SettlementLaw law = {};
    double block = 0.1; ///< largest change of a level within a block, of R0 / tie_support
    /// m, settlement of a good track from one tamping to the next; 0: there is none. Beds settle
    /// afterwards as before: what a tamping machine loosens is not modelled.
    double tamping = 0;
};

/// The states at these settlements of a good track (m, ascending). The random numbers of a stretch
/// follow from `number`. Throws InputError.
std::vector<StretchState> settle_track(const SettlingTrack& track,
                                       const std::vector<double>& settlements,
                                       std::uint64_t number);

} // namespace bris

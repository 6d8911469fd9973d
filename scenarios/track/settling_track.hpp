#pragma once

#include "scenarios/ballast_box/rail.hpp"

#include <cstdint>
#include <vector>

namespace bris {

/// A stretch of track whose ties settle at different rates. No ballast is computed: each axle
/// lowers the bed of tie i by A r_i (R_i / R0)^m, where R_i is the largest force of the bed on the
/// tie as the axle passes, R0 that on an even track, and A what a good tie of an even track
/// settles. So time is counted in the settlement of a good track. Gaps below ties emerge from the
/// rail, which is straight where it is not loaded.
struct SettlingTrack {
    unsigned ties = 41, mud_ties = 3; ///< the mud is in the middle; beyond lie even, good ties
    double spacing = 0.61;            ///< m
    double ratio = 2;                 ///< r of mud ties: settlement over that of good ones
    double exponent = 2.5;            ///< m
    double scatter = 0.5;     ///< standard deviation of ln r_i from tie to tie, also without mud
    double axle_load = 220e3; ///< N, of single axles
    double tie_support = 30e6, rail_bending = 1.58e7; ///< N/m, of a tie; N m2, of both rails
    double weight = 4.6e3;                            ///< N, of rails, fastenings and tie
    double block = 0.1; ///< largest change of a level within a block, of R0 / tie_support

    bool is_mud(std::size_t tie) const;
};

/// The stretch when a good track has settled by `settled`.
struct StretchState {
    double settled = 0;                   ///< m
    std::vector<double> settlements = {}; ///< m, of the bed of each tie
    std::vector<double> voids = {};       ///< m, between tie and bed without a train
    std::vector<double> loads =
        {}; ///< largest force of the bed on each tie, over that of an even track
    std::vector<double> profile = {}; ///< m, downwards, of the rail at each tie below an axle there
};

/// The states at these settlements of a good track (m, ascending). The random numbers of a stretch
/// follow from `number`. Throws InputError.
std::vector<StretchState> settle_track(const SettlingTrack& track,
                                       const std::vector<double>& settlements,
                                       std::uint64_t number);

/// m, the largest departure of a profile from the middle of a chord, downwards; NaN: the stretch is
/// shorter than the chord.
double dip_over_chord(const std::vector<double>& profile, double spacing, double chord);

} // namespace bris

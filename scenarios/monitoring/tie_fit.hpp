#pragma once

#include "scenarios/monitoring/passing_pattern.hpp"
#include "scenarios/sensors/recording.hpp"

#include <string>

namespace bris {

/// A number, and the range of those that fit nearly as well.
struct Estimate {
    double value = 0, low = 0, high = 0;
};

/// How a tie with a sensor gives way under a train that is known.
struct TieFit {
    double speed = 0, band = 0; ///< m/s, at which it fits best; Hz
    double left = 1;            ///< share of the power up to `band` that is not explained
    Estimate deflection = {};   ///< m, largest, from where the tie lies or hangs at rest
    Estimate gap = {};          ///< m, void below the tie: what it moves before it is carried
    /// Whether the tie reaches its bed for certain; else both may be larger than their ranges.
    bool is_carried = true;
    std::string impossible_because = {}; ///< empty: there is one
};

/// Fits the downward acceleration of a tie (downward_acceleration) by that of a tie which follows
/// the rail until its gap is closed and is then carried by a bed: w for w < g, else g + s (w - g),
/// where w is the deflection of the rail by the axles if nothing carries this tie (TrackRail, ties
/// on either side on `passing.rails`), g the gap and s = K / (K + k) by the stiffnesses of the rail
/// there and of the bed. All are without frequencies below `lowest` (Hz) and above four wave
/// numbers of the rails, where the tie does not follow the load alone. The speed is the one within
/// 5 % of the stated one at which the tie without a bed fits best. Gap and s are searched over a
/// grid; the ranges are those of fits that leave at most twice as much as the best one. A bed that
/// hardens is seen as one with a gap; of a tie whose neighbours hang, too, the rail comes down
/// further than w. Impossible are recordings as by downward_acceleration, and
/// those of which the fit leaves more than a fifth.
TieFit fit_tie(const Recording& recording, const PassingTrain& passing, double lowest = 0.7);

} // namespace bris

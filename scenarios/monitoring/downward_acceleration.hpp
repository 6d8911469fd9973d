#pragma once

#include "scenarios/sensors/recording.hpp"

#include <string>
#include <vector>

namespace bris {

/// The downward acceleration that a sensor recorded while a train passed.
struct DownwardAcceleration {
    std::vector<double> series = {};     ///< m/s2, less its line
    double rate = 0, duration = 0;       ///< Hz, s
    std::string impossible_because = {}; ///< empty: there is one
};

/// With the specific force turned back by the angular rates; samples that are missing for at most
/// 0.05 s are interpolated. Impossible are recordings shorter than 95 % of `passing_time` (s) or
/// than 2 / `lowest` (Hz), with longer gaps, with samples at the end of the range, or with one that
/// is no number.
DownwardAcceleration downward_acceleration(const Recording& recording, double passing_time,
                                           double lowest);

} // namespace bris

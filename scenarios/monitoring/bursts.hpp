#pragma once

#include "scenarios/sensors/recording.hpp"

#include <cstddef>
#include <vector>

namespace bris {

/// From when to when something passed, s.
struct Burst {
    double begin = 0, end = 0;
};

/// The bursts of a recording, and how many were too short to be trains.
struct Bursts {
    std::vector<Burst> all;
    std::size_t too_short = 0;
};

/// When recordings of the same clock vibrate much more than in their quieter quarter: the root mean
/// square over 0.25 s about the mean of 4 s exceeds four times its lower quartile in one of them.
/// Bursts with less than `quiet` (s) between them are one; those of less than 0.5 s are counted. A
/// recording that is loud for more than three quarters of its time has none.
Bursts bursts_in(const std::vector<Recording>& recordings, double quiet);

} // namespace bris

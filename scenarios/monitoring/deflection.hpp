#pragma once

#include "components/load.hpp"
#include "scenarios/recordings/recording.hpp"

#include <string>

namespace bris {

/// The deflection of a sensor rock under a passing train.
struct RecordedDeflection {
    double largest = 0;                  ///< m, downwards in one load cycle
    double deviation = 0;                ///< m, standard deviation of its error
    std::string impossible_because = {}; ///< empty: there is one
};

/// From the vertical acceleration (vibration_of) of a recording that begins and ends with the rock
/// at rest: displacement_of above `lowest` (Hz), and its largest_fall, times what the lost
/// frequencies take from the largest_fall of `load`, the force of the train on the tie (any unit,
/// passing_load). Samples that are missing for at most 0.05 s are interpolated. The deviation is
/// that of the sensor's noise and 5 % of the deflection, since a rock does not follow the load
/// exactly (tests/scenarios/monitoring/deflection_test.cpp). Impossible are recordings shorter than
/// 95 % of the load or than 2 / lowest, with longer gaps, or with samples at the end of the range.
RecordedDeflection deflection_of(const Recording& recording, const LoadHistory& load,
                                 double lowest = 0.7);

} // namespace bris

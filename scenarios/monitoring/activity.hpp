#pragma once

#include "scenarios/monitoring/samples.hpp"
#include "scenarios/monitoring/vibration.hpp"

#include <vector>

namespace bris {

/// When a sensor vibrates as under a train.
struct ActivitySettings {
    VibrationQuantity quantity = VibrationQuantity::vertical;
    double threshold = 0; ///< m/s2, or rad/s, root mean square; 0: nothing counts as a train
    double quiet = 5;     ///< s without activity that end a passage
    double longest = 120; ///< s; a longer passage is cut there
    double margin = 1;    ///< s of quiet that a passage has before and after
};

/// s on either side of a sample that say whether the sensor vibrates there.
inline constexpr double activity_context = 2;

/// Says of each row up to the time `until` whether the sensor vibrates: its root mean square over
/// 0.25 s about the mean over 4 s exceeds the threshold. Rows with a state keep it; rows need
/// `activity_context` on either side, so the states do not depend on when they are asked for.
void find_activity(Samples& samples, const SensorInfo& info, const ActivitySettings& settings,
                   double until);

/// From the first to the last active row of a passage, s.
struct PassageInterval {
    double begin = 0, end = 0;
};
/// The passages of rows in order: active rows with less than `quiet` between them, cut at
/// `longest` from their beginning.
std::vector<PassageInterval> passages_in(const Samples& samples, const ActivitySettings& settings);

} // namespace bris

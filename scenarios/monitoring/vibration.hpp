#pragma once

#include "engine/signal/roll_pitch_yaw.hpp"
#include "scenarios/sensors/recording.hpp"

#include <string>
#include <vector>

namespace bris {

/// What of a vibration is compared: vertical acceleration, the specific force along its mean
/// direction at rest, less its mean there (m/s2); or the angular rate about the track (x), the tie
/// (y) or the vertical (z), less its mean (rad/s), in world axes by the attitude of the metadata.
enum class VibrationQuantity { vertical, roll_rate, pitch_rate, yaw_rate };
const std::vector<std::string>& texts_of(VibrationQuantity);
/// The axis of an angular rate.
Eigen::Index axis_of(VibrationQuantity rate);

/// The series of one quantity from a recording, in runs of samples without gaps.
struct Vibration {
    std::vector<std::vector<double>> runs = {}; ///< m/s2, or rad/s
    std::vector<double> begins = {};            ///< s, time of the first sample of each run
    double rate = 0;                            ///< Hz
    double duration = 0;                        ///< s, from the first sample to the last
    double missing = 0;                         ///< share of the samples due in that time
    double measured_rate = 0;                   ///< Hz, by the number of samples and the duration
    double saturated = 0;                       ///< share of the samples at the end of the range
    double rms = 0;                             ///< root of the mean square about the mean
    std::string impossible_because = {};        ///< why there is no series; empty: there is one
};

/// The rocks are at rest in the first `rest` seconds. Runs end where a sample is missing by its
/// time or its count. The recording must have passed quality control.
Vibration vibration_of(const Recording& recording, VibrationQuantity quantity, double rest);

/// The part of a vibration in which a train passes: from the first to the last window of 0.25 s
/// whose root mean square exceeds `threshold` (m/s2, or rad/s). Its rms is that of this part, 0 if
/// there is none.
Vibration passing_part(const Vibration& whole, double threshold);

/// Root mean square of the angular rate over that of the specific force, each about its mean,
/// rad/s per m/s2. NaN if one of the two was not recorded or does not vary.
double rate_per_force(const Recording& recording);

/// Root mean squares (rad) of roll, pitch and yaw about their straight lines of least squares: of
/// the recorded attitudes, or else of the integrated angular rates less their mean (trapezium rule,
/// from the attitude of the metadata). NaN if neither was recorded.
RollPitchYaw rotation_rms(const Recording& recording);

} // namespace bris

#pragma once

#include "scenarios/sensors/recording.hpp"

#include <span>
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

/// Whether two sampling rates (Hz) are one, as loggers' clocks keep it: within 1 %.
inline bool is_same_rate(double a, double b) { return a < 1.01 * b && b < 1.01 * a; }

/// The series of one quantity from a recording, in runs of samples without gaps.
struct Vibration {
    std::vector<std::vector<double>> runs = {}; ///< m/s2, or rad/s
    std::vector<double> begins = {};            ///< s, time of the first sample of each run
    std::vector<std::size_t> firsts = {};       ///< index of that sample in the recording
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

/// Samples of a recording that are compared: indices from begin to before end, without gaps.
struct SampleRange {
    std::size_t begin = 0, end = 0;
};

/// The windows of 0.25 s in which a train passes, joined where less than 0.5 s lie between them:
/// those whose root mean square exceeds `share` of that of the loudest tenth of all windows above
/// `presence` (m/s2, or rad/s). So a train that stops, a second train and a long approach do not
/// change what is compared, and nor does the level of the whole. Empty: no window is above
/// `presence`.
std::vector<SampleRange> active_ranges(const Vibration& vibration, double presence, double share);
/// All samples, in ranges without gaps.
std::vector<SampleRange> whole_ranges(const Vibration& vibration);
/// The series in some ranges.
std::vector<std::vector<double>> runs_in(const Vibration& vibration,
                                         const std::vector<SampleRange>& ranges);

/// Mean of a series, and mean square about it; NaN without samples.
struct Moments {
    double mean, square;
};
Moments moments_of(std::span<const std::vector<double>> runs);

/// Root mean square of the angular rate over that of the specific force, each about its mean,
/// rad/s per m/s2. NaN if one of the two was not recorded or does not vary.
double rate_per_force(const Recording& recording);

} // namespace bris

#pragma once

#include "scenarios/monitoring/passage.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// State of the ballast in a synthetic recording, as factors on the motion in clean ballast.
struct SyntheticState {
    double level = 1;     ///< of all motion
    double roll = 1;      ///< of roll, in addition
    double frequency = 1; ///< of the resonances
};
/// "clean"; "fouled": twice the vibration and four times the roll (the SmartRock report found "two
/// times more" vibration and more roll beside a mud spot; these factors are chosen, not measured);
/// "loosened": resonances at 0.75 of their frequency. Throws InputError for any other name.
SyntheticState synthetic_state(std::string_view name);

/// Settings of synthetic passages.
struct SyntheticVibration {
    unsigned sensors = 4;
    double rate = 200;            ///< Hz
    double lead = 1.5;            ///< s at rest before the train, and after it
    double duration = 6;          ///< s of the passage
    double bogie_interval = 0.8;  ///< s between bogie pairs
    double level = 0.5;           ///< m/s2, standard deviation of the vibration between bogies
    double pulse = 1.0;           ///< m/s2, of the slow acceleration under a bogie pair
    double rotation = 2e-3;       ///< rad, standard deviation of pitch and yaw; roll has half of it
    double passage_scatter = 0.1; ///< of the logarithm of the level, from passage to passage
    double sensor_scatter = 0.2;  ///< likewise from sensor to sensor, constant in time
    std::string device = "smartrock-like"; ///< imu_preset
};

/// Synthetic recordings of a train passage; not field data, and no claim about ballast. The
/// vertical acceleration is a stated autoregressive process of order 4 (resonances at 22 Hz and 58
/// Hz with pole radii 0.95 and 0.9, at a rate of 200 Hz) times an envelope that is 1 during the
/// passage and 1.5 under a bogie pair, plus a pulse of each bogie pair (second derivative of a bell
/// curve of 60 ms); both horizontal accelerations are 0.4 times such a process; roll, pitch and
/// yaw are processes of order 2 (6 Hz) times the envelope. The device model (engine/signal/imu)
/// turns this into samples. All numbers follow from (seed, passage, sensor).
Passage synthetic_passage(const SyntheticVibration& settings, const SyntheticState& state,
                          std::uint64_t seed, unsigned passage, const std::string& name);

/// The true vertical acceleration (m/s2) of one sensor in such a passage, at the rate of the
/// settings, with the rest before and after it.
std::vector<double> synthetic_vertical(const SyntheticVibration& settings,
                                       const SyntheticState& state, std::uint64_t seed,
                                       unsigned passage, unsigned sensor);

} // namespace bris

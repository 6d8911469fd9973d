#pragma once

#include "scenarios/monitoring/sensor_baseline.hpp"

#include <cstddef>
#include <vector>

namespace bris {

/// A lasting change of the level that is to be found: by how many sensors beside it, in how many
/// passages judged together, at which probability of a false alarm.
struct PlannedChange {
    double ratio = 1.25; ///< of root mean squares
    std::size_t sensors = 1, passages = 1;
    double false_alarms = 0.02;
};

/// How the levels of a site scatter, by its baseline.
struct LevelScatter {
    std::vector<ExpectedFeature> levels = {}; ///< of each sensor
    double serial = 0, between = 0;           ///< see SensorModel
    double common = 0;                        ///< correlation of different sensors
    std::size_t features = 1;                 ///< that are judged of each sensor
};
/// Throws InputError if no sensor has a baseline.
LevelScatter level_scatter(const std::vector<SensorBaseline>& baselines);

/// Probability that any of the sensors, which are like those of the baseline in turn, raises the
/// alarm of judge_together by its level: the share of normally distributed runs, which are the same
/// for the same seed.
double power_of(const LevelScatter& scatter, const PlannedChange& change, std::size_t draws = 4000,
                std::uint64_t seed = 11);

} // namespace bris

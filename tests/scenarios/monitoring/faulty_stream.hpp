#pragma once

#include "engine/random.hpp"
#include "scenarios/monitoring/passage_stream.hpp"
#include "scenarios/monitoring/sensor_verdict.hpp"
#include "scenarios/monitoring/synthetic_vibration.hpp"
#include "scenarios/stream/broker_lines.hpp"
#include "tests/given_lines.hpp"

#include <functional>
#include <string>
#include <vector>

namespace bris::testing {

/// One sample on its way from a sensor to the monitor. A fault changes any of it.
struct Sent {
    unsigned sensor = 0;
    double true_time = 0; ///< s
    double t = 0;         ///< s, by the sensor's clock
    std::uint64_t seq = 0;
    double arrival = 0; ///< s
    bool retained = false;
    Vec3 force, rate;
};

/// Trains that pass sensors in clean ballast, with quiet before and after each.
struct TrainDay {
    std::vector<SensorInfo> infos;
    std::vector<SensorBaseline> baselines;
    MonitorSettings settings;
    std::vector<Sent> samples; ///< in order of arrival
};

/// How lines come to the monitor.
enum class Way { broker, pipe, file };

TrainDay make_day(unsigned sensors, unsigned trains, double interval, std::uint64_t seed);

/// Verdicts of all final passages, one line each: "1 as the baseline, 2 changed ...".
struct DayResult {
    std::vector<std::string> passages;
    std::size_t all_clear = 0; ///< of sensors in passages
    std::size_t changed = 0, time_unknown = 0, not_enough_data = 0;
    StreamCounts counts;
    std::string report;
    std::vector<std::string> given; ///< every passage and revision with the bits of its numbers
};

DayResult follow(const TrainDay& day, std::vector<Sent> samples, Way way,
                 PassageStreamSettings settings = {});

/// The same by a monitor that logs and is killed when `down` (s of arrival) begins, and that is
/// resumed when it ends, with a clock of arrivals that is `ahead` (s) of what it was: what came
/// meanwhile arrives then. Also what a replay of the whole log gives.
struct RestartedDay {
    DayResult found, replayed;
};
RestartedDay follow_restarted(const TrainDay& day, std::vector<Sent> samples, Way way,
                              PassageInterval down, double ahead);

} // namespace bris::testing

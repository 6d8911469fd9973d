#pragma once

#include "scenarios/monitoring/comparison.hpp"
#include "scenarios/monitoring/sensor_baseline.hpp"
#include "scenarios/monitoring/verdict.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace bris {

struct Feature;

/// What a change of this feature is called.
Verdict verdict_of(const Feature& feature, double difference);
/// "vertical vibration 1.85 times", or in standard deviations what is no ratio.
std::string change_text(const Feature& feature, double difference, double deviation);

/// A feature of a passage beside what is expected of it; NaN: not judged.
struct JudgedFeature {
    double difference = std::numeric_limits<double>::quiet_NaN(); ///< from the expected mean
    double deviation = std::numeric_limits<double>::quiet_NaN();  ///< of a passage from that mean
    double p = std::numeric_limits<double>::quiet_NaN();
    double seen = std::numeric_limits<double>::quiet_NaN(); ///< change that is seen in 90 %
    bool is_changed = false;
    ExpectedFeature expected = {};
};

/// The recording of one sensor beside its baseline. NaN: not computed.
struct SensorResult {
    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

    unsigned id = 0;
    Verdict verdict = Verdict::not_enough_data;
    std::string reason;
    double duration = 0; ///< s, of the recording
    double turned = 0;   ///< rad, direction of gravity from that of the baseline
    std::vector<JudgedFeature> features = {}; ///< in the order of all_features(); empty: none
    std::array<double, readings.size()> outlier_shares{unknown, unknown, unknown};
    ChartPoints points = {};
    Spectrum spectrum = {}; ///< without segments: not computed

    /// Root mean square over that of the baseline.
    double level_ratio() const;
    /// Ratios of levels between which no change would be seen in 90 % of passages.
    double seen_below() const;
    double seen_above() const;
};

/// One passage: all sensors of the baseline and of the recordings, in order of their ids.
struct PassageResult {
    std::string name;
    std::vector<SensorResult> sensors = {};
    std::vector<Finding> findings = {}; ///< of quality control
    std::uint64_t id = 0;               ///< of a stream: the same in all revisions
    unsigned revision = 1;
    bool is_final = true; ///< false: late records may change it
};

/// The verdict on a passage as a whole: the most serious one of its sensors.
Verdict verdict_on(const PassageResult& passage);

/// Compares a passage with the baselines. Each feature of each sensor is compared with what its own
/// baseline expects, so that the probability of any alarm in an unchanged passage is at most
/// `false_alarms` (Holm). A sensor is as its baseline only if nothing forbids to say so: it has a
/// baseline, quality control accepts its recording, its sampling rate is that of the baseline, few
/// samples are missing or saturated, enough are without gaps, its recording is not one of the
/// baseline, and it was not turned.
PassageResult judge_passage(const Passage& passage, const std::vector<SensorBaseline>& baselines,
                            const MonitorSettings& settings);

/// The most serious result of several passages, of all sensors or of one; of equals, the one with
/// the least probable deviation. Null: there is none.
struct MostSerious {
    const PassageResult* passage = nullptr;
    const SensorResult* sensor = nullptr;
};
MostSerious most_serious_result(const std::vector<PassageResult>& passages,
                                std::optional<unsigned> sensor = {});

} // namespace bris

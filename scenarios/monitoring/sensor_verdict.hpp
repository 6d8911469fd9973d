#pragma once

#include "scenarios/monitoring/sensor_baseline.hpp"

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// What the recording of a sensor says about the track beside it. `no_train`: nothing passed, so
/// nothing is said. `time_unknown`: nothing says when it was recorded. An all-clear, `as_baseline`,
/// needs a recording in which a change would be seen.
enum class Verdict { as_baseline, changed, not_enough_data, no_train, time_unknown };
/// "as the baseline", "changed", "not enough data", "no train", "time unknown".
const char* text_of(Verdict verdict);

/// The recording of one sensor beside its baseline. NaN: not computed.
struct SensorResult {
    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

    unsigned id = 0;
    Verdict verdict = Verdict::not_enough_data;
    std::string reason;
    double duration = 0;            ///< s, of the recording
    double outlier_share = unknown; ///< of the points of its charts
    double level_ratio = unknown;   ///< of root mean squares, to the baseline
    double power_ratio = unknown;   ///< of band powers, to the baseline
    double entropy = unknown;       ///< spectral, of the band
    double ewma_share = unknown;    ///< of points at which the moving average is outside
    double cusum_share = unknown;   ///< of points at which a cumulative sum is above its limit
    RollPitchYaw rotation_ratio{unknown, unknown, unknown}; ///< of root mean squares
    ChartPoints points;
    Spectrum spectrum; ///< without segments: not computed
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

/// Numbers of passages by verdict.
struct PassageTally {
    std::size_t as_baseline = 0, changed = 0, no_train = 0, not_enough_data = 0, time_unknown = 0;
    void add(Verdict verdict, int count = 1);
    std::size_t all() const;
    /// "as the baseline in 15 of 25 passages; 10 not judged: no train".
    std::string sentence() const;
    /// "10 not judged: no train"; empty: all were judged.
    std::string not_judged() const;
};

/// Compares a passage with the baselines. A sensor has changed if more than `alarm_share` of its
/// points lie outside the limits. It is as its baseline only if nothing forbids to say so: it has a
/// baseline, quality control accepts its recording, its sampling rate is that of the baseline, few
/// samples are missing or saturated, enough are without gaps, its recording is not one of the
/// baseline, and it moved while the others did.
PassageResult judge_passage(const Passage& passage, const std::vector<SensorBaseline>& baselines,
                            const MonitorSettings& settings);

/// The most serious result of several passages, of all sensors or of one: changed, time unknown,
/// not enough data, as the baseline, no train; of equals, the one with the largest share of
/// outliers. Null: there is none.
struct MostSerious {
    const PassageResult* passage = nullptr;
    const SensorResult* sensor = nullptr;
};
MostSerious most_serious_result(const std::vector<PassageResult>& passages,
                                std::optional<unsigned> sensor = {});

/// The verdict of the most serious result. If no train passed in any passage, there is not enough
/// data.
struct OverallVerdict {
    Verdict verdict = Verdict::not_enough_data;
    std::string reason;
};
OverallVerdict overall_verdict(const std::vector<PassageResult>& passages,
                               std::optional<unsigned> sensor = {});

} // namespace bris

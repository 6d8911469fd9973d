#pragma once

#include "scenarios/monitoring/sensor_verdict.hpp"

#include <optional>
#include <string>
#include <vector>

namespace bris {

/// The verdict on several passages together.
struct OverallVerdict {
    Verdict verdict = Verdict::not_enough_data;
    std::string reason = {};
};

/// Several passages of one sensor together.
struct SensorSummary {
    unsigned id = 0;
    OverallVerdict overall = {};
    std::size_t judged = 0;                     ///< passages
    Trend level = {};                           ///< of the vertical
    double level_ratio = SensorResult::unknown; ///< geometric mean
    /// Ratios between which a lasting change would not be seen in 90 % of such runs.
    double seen_below = SensorResult::unknown, seen_above = SensorResult::unknown;
    double change_a_passage = SensorResult::unknown; ///< share by which the level drifts
};

/// Judges passages together: of each feature their mean, a straight line from the baseline on, and
/// each by itself, so that the probability of any alarm is at most `false_alarms` if nothing has
/// changed. So one passage of many may differ by itself and yet be no alarm. Sensors in order of
/// their ids. A sensor is as its baseline only if every passage in which a train passed was judged.
std::vector<SensorSummary> judge_together(const std::vector<PassageResult>& passages,
                                          const std::vector<SensorBaseline>& baselines,
                                          double false_alarms);

/// The verdict on the site: that of its most serious sensor. If no train passed in any passage,
/// there is not enough data.
OverallVerdict overall_verdict(const std::vector<SensorSummary>& sensors);

} // namespace bris

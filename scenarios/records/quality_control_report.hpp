#pragma once

#include "scenarios/records/recorded_test.hpp"

#include <string>
#include <utility>
#include <vector>

namespace bris {

/// Lines "sensor 3: text" in order. Sensors with the same text share a line, as in
/// "sensors 1 to 4, 7: text".
std::string lines_by_sensor(const std::vector<std::pair<unsigned, std::string>>& texts);

/// Text for people: which sensors are accepted, which are refused and why, and all other findings.
std::string quality_control_report(const std::vector<Finding>& findings,
                                   const std::vector<Recording>& recordings);
/// The same, preceded by the test machine.
std::string quality_control_report(const RecordedTest& test);

/// A table of what the accepted sensors of a test can observe after `duration` (s) if the model's
/// displacement and rotation have these standard deviations (m, rad; see observability_of), with an
/// explanation of its columns.
std::string observability_report(const RecordedTest& test, double duration,
                                 double displacement_deviation, double rotation_deviation);

/// The channels of the test machine that are refused, separated by commas; "none".
std::string refused_channels(const RecordedTest& test);

/// One sentence for the screen: how many sensors are accepted, what of the test machine is refused,
/// and what the model can still learn from.
std::string verdict_on(const RecordedTest& test);

} // namespace bris

#pragma once

#include "scenarios/records/recorded_test.hpp"

#include <filesystem>

namespace bris {

/// Draws every channel that the sensors recorded, one panel for each component with a curve for
/// each sensor, as sensors.png, and those of the test machine as machine.png, in a folder. A curve
/// has at most some 2 000 points. Refused sensors are drawn dashed.
void draw_recordings(const std::filesystem::path& folder, const RecordedTest& test);

} // namespace bris

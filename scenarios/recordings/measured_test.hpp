#pragma once

#include "scenarios/recordings/recorded_test.hpp"

#include <vector>

namespace bris {

/// What was measured in a test: q (Pa) and volumetric strain (NaN: not, or left out) by axial
/// strain, in order of strain, and the ways of the sensor rocks, if there are.
struct MeasuredTest {
    std::vector<double> strain, q, volumetric_strain;
    std::vector<SensorTrajectory> trajectories = {};
    double displacement_noise = 1e-4;  ///< m, of them, root mean square
    double lateness = 0;               ///< of strain, by which their samples come late
    std::vector<double> rejected = {}; ///< strains of q that was not believed
};
MeasuredTest measured_test(const std::vector<TriaxialPoint>& points);
MeasuredTest measured_test(const RecordedTest& test);

} // namespace bris

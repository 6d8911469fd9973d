#pragma once

#include "scenarios/recordings/recorded_test.hpp"

#include <vector>

namespace bris {

/// Measurements of a test: q (Pa) and volumetric strain over axial strain, in order of strain (NaN:
/// not measured, or removed by quality control), and the trajectories of the sensor rocks, if any.
struct MeasuredTest {
    std::vector<double> strain, q, volumetric_strain;
    std::vector<SensorTrajectory> trajectories = {};
    double displacement_noise = 1e-4;  ///< m, of the trajectories, root mean square
    std::vector<double> rejected = {}; ///< axial strains at which q was rejected
};
MeasuredTest measured_test(const std::vector<TriaxialPoint>& points);
MeasuredTest measured_test(const RecordedTest& test);

} // namespace bris

#include "scenarios/recordings/measured_test.hpp"

#include <cmath>

namespace bris {

MeasuredTest measured_test(const std::vector<TriaxialPoint>& points) {
    MeasuredTest s;
    for (const TriaxialPoint& p : points) {
        s.strain.push_back(p.axial_strain);
        s.q.push_back(p.deviatoric_stress);
        s.volumetric_strain.push_back(p.volumetric_strain);
    }
    return s;
}

MeasuredTest measured_test(const RecordedTest& test) {
    MeasuredTest s = measured_test(test.measured);
    s.trajectories = test.trajectories;
    double squares = 0;
    for (const Recording& r : test.recordings)
        squares += r.info.displacement_noise * r.info.displacement_noise;
    s.displacement_noise = std::sqrt(squares / static_cast<double>(test.recordings.size()));
    return s;
}

} // namespace bris

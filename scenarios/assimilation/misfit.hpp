#pragma once

#include "scenarios/assimilation/model_run.hpp"
#include "scenarios/recordings/recorded_test.hpp"

#include <limits>
#include <vector>

namespace bris {

/// Radial strains of the rings, from below, at the point with an axial strain; empty if there is
/// none with as many rings as the first point.
std::vector<double> ring_strains(const std::vector<TriaxialPoint>& points, double axial_strain);
/// Root mean square difference over the rings that both profiles know (others are NaN); NaN if they
/// have not the same number of rings, or none.
double ring_difference(const std::vector<double>& a, const std::vector<double>& b);

/// Root mean square differences between a model and a test, over the strains that both have; NaN
/// where nothing was measured.
struct Misfit {
    double q = 0, volumetric_strain = 0; ///< Pa, -
    double ring_strain = 0;              ///< -, at the end of the run, whatever the last strain
    double sensor_displacement = 0;      ///< m
};
/// The misfit up to `last_strain`.
Misfit misfit_of(const ModelRun& run, const RecordedTest& test,
                 double last_strain = std::numeric_limits<double>::infinity());

} // namespace bris

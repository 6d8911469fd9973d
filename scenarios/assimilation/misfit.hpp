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

/// Axial strains above the first, up to the second.
struct StrainRange {
    double from = 0, to = std::numeric_limits<double>::infinity();
    bool holds(double strain) const;
};

/// Root mean square difference of one number between a curve and a measured one, over the strains
/// of a range that both have; NaN where nothing was measured.
double curve_difference(const std::vector<TriaxialPoint>& curve,
                        const std::vector<TriaxialPoint>& measured, const StrainRange& range,
                        double TriaxialPoint::*value);

/// Root mean square differences between a model and a test, over the strains that both have; NaN
/// where nothing was measured.
struct Misfit {
    double q = 0, volumetric_strain = 0; ///< Pa, -
    double ring_strain = 0;              ///< -, at the end of the run, whatever the last strain
    double sensor_displacement = 0;      ///< m
};
Misfit misfit_of(const ModelRun& run, const RecordedTest& test, const StrainRange& range = {});

} // namespace bris

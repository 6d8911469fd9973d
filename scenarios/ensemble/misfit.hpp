#pragma once

#include "scenarios/ensemble/model_run.hpp"
#include "scenarios/records/recorded_test.hpp"

#include <limits>
#include <vector>

namespace bris {

/// Radial strains of the rings, from below, at the row with an axial strain; empty if there is
/// none.
std::vector<double> ring_strains(const TestCurves& curves, double axial_strain);
/// Root mean square difference over the rings that both profiles know (others are NaN); NaN if they
/// have not the same number of rings, or none.
double ring_difference(const std::vector<double>& a, const std::vector<double>& b);

/// Axial strains above the first, up to the second.
struct StrainRange {
    double from = 0, to = std::numeric_limits<double>::infinity();
    bool holds(double strain) const;
};

/// Root mean square difference of a quantity between measured curves and those of a model, over the
/// strains of a range that both have; NaN where nothing was measured.
double curve_difference(const MeasuredCurves& measured, const TestCurves& predicted,
                        const StrainRange& range, const Quantity& quantity);

/// Root mean square differences between a test and a model, over the strains that both have; NaN
/// where nothing was measured.
struct Misfit {
    double q = 0, volumetric_strain = 0; ///< Pa, -
    double ring_strain = 0;              ///< -, at the end of the run, whatever the last strain
    double sensor_displacement = 0;      ///< m
};
Misfit misfit_of(const Measurements& test, const ModelRun& run, const StrainRange& range = {});

} // namespace bris

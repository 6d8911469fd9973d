#pragma once

#include "scenarios/triaxial/triaxial_results.hpp"

#include <functional>

namespace bris {

/// Curves of a test as it was measured, of the model alone, and of the model that assimilates the
/// measurements. Null or empty: left out.
struct ComparedTests {
    const TestCurves* measured = nullptr;
    const TestCurves* dem_only = nullptr;
    const TestCurves* fused = nullptr;
};

/// A curve from its label, test and style, as `curve_of` and `profile_of` make them.
using MakeCurve = std::function<Curve(const std::string&, const TestCurves&, Curve::Style)>;

/// Curves that have the same words, styles and colours in every picture, whichever of them are
/// there: "measured" (dots, about a hundred), "DEM only" (dashed) and "fused" (solid).
std::vector<Curve> compared_curves(const ComparedTests& tests, const MakeCurve& make);

/// One quantity against axial strain, for `compared_curves`.
MakeCurve curves_of(const Quantity& quantity);

/// Adds a vertical line at the axial strain up to which measurements are assimilated, if the curves
/// of the panel go beyond it.
void mark_end_of_learning(Plot& panel, double strain);

} // namespace bris

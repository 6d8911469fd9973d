#pragma once

#include "scenarios/triaxial/triaxial_results.hpp"

#include <functional>

namespace bris {

/// Points of a test as it was measured, of the model alone, and of the model that assimilates the
/// measurements. Null or empty: left out.
struct ComparedPoints {
    const std::vector<TriaxialPoint>* measured = nullptr;
    const std::vector<TriaxialPoint>* dem_only = nullptr;
    const std::vector<TriaxialPoint>* fused = nullptr;
};

/// A curve from its label, points and style, as `curve_of` and `profile_of` make them.
using MakeCurve =
    std::function<Curve(const std::string&, const std::vector<TriaxialPoint>&, Curve::Style)>;

/// Curves that have the same words, styles and colours in every picture, whichever of them are
/// there: "measured" (dots, about a hundred), "DEM only" (dashed) and "fused" (solid).
std::vector<Curve> compared_curves(const ComparedPoints& points, const MakeCurve& make);

/// One quantity of the points against axial strain (%), multiplied by `scale`, for
/// `compared_curves`.
MakeCurve curves_of(double scale, double TriaxialPoint::*value);

/// Adds a vertical line at the axial strain up to which measurements are assimilated, if the curves
/// of the panel go beyond it.
void mark_end_of_learning(Plot& panel, double strain);

} // namespace bris

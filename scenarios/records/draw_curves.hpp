#pragma once

#include "engine/io/plot.hpp"
#include "scenarios/records/test_curves.hpp"

#include <string>
#include <vector>

namespace bris {

/// A quantity against axial strain in per cent, in kPa, mm or per cent.
Curve curve_of(const std::string& label, const TestCurves& curves, const Quantity& quantity,
               Curve::Style style = Curve::Style::line, std::size_t part = 0);

/// A predicted quantity in this way, with the ends of its band in the same colour.
std::vector<Curve> curves_with_band(const TestCurves& curves, const Quantity& quantity,
                                    const std::string& label = "library (dashed: 90 % band)");

} // namespace bris

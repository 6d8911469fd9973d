#include "scenarios/ensemble/compared_curves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

/// About a hundred of the rows, and the last one.
TestCurves thinned(const TestCurves& curves) {
    const std::size_t every = std::max<std::size_t>(1, curves.size() / 100);
    return curves.rows_where(
        [&](std::size_t k) { return k % every == 0 || k + 1 == curves.size(); });
}

} // namespace

std::vector<Curve> compared_curves(const ComparedTests& tests, const MakeCurve& make) {
    std::vector<Curve> curves;
    const auto add = [&](const char* label, const TestCurves* of, Curve::Style style) {
        // a curve without rows is not drawn, but the next one keeps its colour
        if (of == nullptr || of->empty())
            curves.push_back({.label = label, .style = style});
        else
            curves.push_back(
                make(label, style == Curve::Style::points ? thinned(*of) : *of, style));
    };
    add("measured", tests.measured, Curve::Style::points);
    add("DEM only", tests.dem_only, Curve::Style::dashed);
    add("fused", tests.fused, Curve::Style::line);
    return curves;
}

MakeCurve curves_of(const Quantity& quantity) {
    return [&quantity](const std::string& label, const TestCurves& curves, Curve::Style style) {
        return curve_of(label, curves, quantity, style);
    };
}

void mark_end_of_learning(Plot& panel, double strain) {
    constexpr double none = std::numeric_limits<double>::infinity();
    double last = -none, low = none, high = -none;
    for (const Curve& curve : panel.curves)
        for (std::size_t k = 0; k < curve.x.size(); ++k) {
            if (!std::isfinite(curve.y[k])) continue;
            last = std::max(last, curve.x[k]);
            low = std::min(low, curve.y[k]);
            high = std::max(high, curve.y[k]);
        }
    const double at = 100 * strain;
    if (last > at)
        panel.curves.push_back({"learning ends", {at, at}, {low, high}, Curve::Style::dashed});
}

} // namespace bris

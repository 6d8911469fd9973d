#include "scenarios/assimilation/compared_curves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

/// About a hundred of the points, and the last one.
std::vector<TriaxialPoint> thinned(const std::vector<TriaxialPoint>& points) {
    std::vector<TriaxialPoint> some;
    const std::size_t every = std::max<std::size_t>(1, points.size() / 100);
    for (std::size_t k = 0; k < points.size(); k += every) some.push_back(points[k]);
    if ((points.size() - 1) % every != 0) some.push_back(points.back());
    return some;
}

} // namespace

std::vector<Curve> compared_curves(const ComparedPoints& points, const MakeCurve& make) {
    std::vector<Curve> curves;
    const auto add = [&](const char* label, const std::vector<TriaxialPoint>* of,
                         Curve::Style style) {
        // a curve without points is not drawn, but the next one keeps its colour
        if (of == nullptr || of->empty())
            curves.push_back({.label = label, .style = style});
        else
            curves.push_back(
                make(label, style == Curve::Style::points ? thinned(*of) : *of, style));
    };
    add("measured", points.measured, Curve::Style::points);
    add("DEM only", points.dem_only, Curve::Style::dashed);
    add("fused", points.fused, Curve::Style::line);
    return curves;
}

MakeCurve curves_of(double scale, double TriaxialPoint::*value) {
    return [=](const std::string& label, const std::vector<TriaxialPoint>& points,
               Curve::Style style) { return curve_of(label, points, scale, value, style); };
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

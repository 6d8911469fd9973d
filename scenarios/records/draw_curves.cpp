#include "scenarios/records/draw_curves.hpp"

#include <string_view>

namespace bris {

namespace {

Curve drawn(const std::string& label, const TestCurves& curves, const Quantity& quantity,
            const std::vector<double>& values, Curve::Style style) {
    const std::string_view unit = quantity.unit;
    const double scale = unit == "Pa" ? 1e-3 : unit == "m" ? 1e3 : unit.empty() ? 100 : 1;
    Curve c{.label = label, .style = style};
    for (const double strain : curves[quantity::axial_strain]) c.x.push_back(100 * strain);
    for (const double value : values) c.y.push_back(scale * value);
    return c;
}

} // namespace

Curve curve_of(const std::string& label, const TestCurves& curves, const Quantity& quantity,
               Curve::Style style, std::size_t part) {
    return drawn(label, curves, quantity, curves.column(quantity, part).values, style);
}

std::vector<Curve> curves_with_band(const TestCurves& curves, const Quantity& quantity,
                                    const std::string& label) {
    const TestCurves::Column& c = curves.column(quantity);
    return {drawn(label, curves, quantity, c.values, Curve::Style::line),
            drawn("", curves, quantity, c.low, Curve::Style::dashed),
            drawn("", curves, quantity, c.high, Curve::Style::dashed)};
}

} // namespace bris

#include "scenarios/library/live_results.hpp"

#include "engine/io/plot.hpp"
#include "scenarios/ensemble/misfit.hpp"

#include <fmt/format.h>

#include <utility>

namespace bris {

void draw_live(const std::filesystem::path& png, const ComparedTests& tests,
               const std::vector<std::vector<double>>& rows, const LivePrediction& prediction,
               double learned_strain) {
    std::vector<Plot> panels;
    const auto panel = [&](const char* title, const char* label, const MakeCurve& make) {
        panels.push_back({.title = title,
                          .x_label = "axial strain (%)",
                          .y_label = label,
                          .curves = compared_curves(tests, make)});
    };
    panel("Deviatoric stress", "q (kPa)", curves_of(quantity::deviatoric_stress));
    panel("Volumetric strain", "volumetric strain (%)", curves_of(quantity::volumetric_strain));
    Plot friction{.title = "Estimated friction coefficient (dashed: one standard deviation)",
                  .x_label = "axial strain (%)",
                  .y_label = "friction"};
    for (const double sign : {0.0, 1.0, -1.0}) { // those without labels in the same colour
        Curve curve{.label = sign == 0 ? "estimate" : "",
                    .style = sign == 0 ? Curve::Style::line : Curve::Style::dashed};
        for (const auto& row : rows) {
            curve.x.push_back(100 * row[0]);
            curve.y.push_back(row[3] + sign * row[4]);
        }
        friction.curves.push_back(std::move(curve));
    }
    panels.push_back(std::move(friction));
    if (prediction.last().not_used.empty()) {
        const TestCurves& predicted = prediction.last().predicted.curves;
        for (Curve& c : curves_with_band(predicted, quantity::deviatoric_stress))
            panels[0].curves.push_back(std::move(c));
        for (Curve& c : curves_with_band(predicted, quantity::volumetric_strain))
            panels[1].curves.push_back(std::move(c));
    }
    for (Plot& plot : panels) mark_end_of_learning(plot, learned_strain);
    if (const RingEstimate& rings = prediction.rings(); rings.not_made.empty()) {
        panels.push_back({.title = fmt::format("Rings at {:g} %", 100 * rings.strain),
                          .x_label = "radial strain, widening positive (%)",
                          .y_label = "ring, from below",
                          .curves = curves_of(rings)});
        panels.back().curves.push_back(ring_curve(
            "measured", ring_strains(*tests.measured, rings.strain), Curve::Style::points));
    }
    draw_plots(png, panels, 3);
}

} // namespace bris

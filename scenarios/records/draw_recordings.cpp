#include "scenarios/records/draw_recordings.hpp"

#include "engine/io/plot.hpp"
#include "scenarios/records/draw_curves.hpp"
#include "scenarios/sensors/channels.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

namespace {

constexpr std::size_t most_points = 2000;

/// A panel with a curve for each sensor that has the channel; `value(recording, k)`.
void add_panel(std::vector<Plot>& panels, const RecordedTest& test, const std::string& label,
               auto&& has, auto&& value) {
    Plot panel{.title = "", .x_label = "time (s)", .y_label = label, .curves = {}};
    for (const Recording& r : test.recordings) {
        if (!has(r)) continue;
        Curve curve{.label = fmt::format("{}", r.info.id)};
        if (!accepted(test.findings, r.info.id)) curve.style = Curve::Style::dashed;
        const std::size_t step = std::max<std::size_t>(1, r.size() / most_points);
        for (std::size_t k = 0; k < r.size(); k += step) {
            curve.x.push_back(r.time[k]);
            curve.y.push_back(value(r, k));
        }
        panel.curves.push_back(std::move(curve));
    }
    if (!panel.curves.empty()) panels.push_back(std::move(panel));
}

std::vector<Plot> panels_of_sensors(const RecordedTest& test) {
    std::vector<Plot> panels;
    for (const Channel* channel : channels_by_kind)
        for (std::size_t part = 0; !channel->is_count() && part < channel->size(); ++part) {
            const auto& [title, unit, scale] = channel->panel;
            add_panel(
                panels, test,
                fmt::format("{}{}", title.empty() ? channel->column(part) : title,
                            unit.empty() ? "" : fmt::format(" ({})", unit)),
                [&](const Recording& r) { return channel->samples(r) > 0; },
                [&](const Recording& r, std::size_t k) {
                    return scale * channel->visit(r, [&](const auto& values) {
                        return components_of(values[k])[part];
                    });
                });
        }
    return panels;
}

std::vector<Plot> panels_of_machine(const RecordedTest& test) {
    std::vector<Plot> panels;
    const auto add = [&](const char* label, std::vector<Curve> curves) {
        panels.push_back({.title = "",
                          .x_label = "axial strain (%)",
                          .y_label = label,
                          .curves = std::move(curves)});
    };
    add("deviatoric stress (kPa)", {curve_of("", test.curves, quantity::deviatoric_stress)});
    add("volumetric strain (%)", {curve_of("", test.curves, quantity::volumetric_strain)});
    std::vector<Curve> rings;
    for (std::size_t r = 0; r < test.curves.rings(); ++r)
        rings.push_back(curve_of(fmt::format("ring {}", r + 1), test.curves, quantity::ring_radius,
                                 Curve::Style::line, r));
    if (!rings.empty()) add("ring radius (mm)", std::move(rings));
    return panels;
}

} // namespace

void draw_recordings(const std::filesystem::path& folder, const RecordedTest& test) {
    if (const auto panels = panels_of_sensors(test); !panels.empty())
        draw_plots(folder / "sensors.png", panels, 3);
    if (test.curves.size() > 1) draw_plots(folder / "machine.png", panels_of_machine(test));
}

} // namespace bris

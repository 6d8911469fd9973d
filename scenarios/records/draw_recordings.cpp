#include "scenarios/records/draw_recordings.hpp"

#include "engine/io/plot.hpp"
#include "scenarios/recordings/device_channels.hpp"
#include "scenarios/records/draw_curves.hpp"

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

void add_vector(std::vector<Plot>& panels, const RecordedTest& test, const char* name,
                const char* unit, double scale, std::vector<Vec3> Recording::*channel) {
    for (Eigen::Index axis = 0; axis < 3; ++axis)
        add_panel(
            panels, test, fmt::format("{}{} ({})", name, "xyz"[axis], unit),
            [&](const Recording& r) { return !(r.*channel).empty(); },
            [&](const Recording& r, std::size_t k) { return scale * (r.*channel)[k][axis]; });
}

std::vector<Plot> panels_of_sensors(const RecordedTest& test) {
    std::vector<Plot> panels;
    add_vector(panels, test, "a", "m/s2", 1, &Recording::force);
    add_vector(panels, test, "g", "rad/s", 1, &Recording::rate);
    add_vector(panels, test, "m", "uT", 1e6, &Recording::field);
    add_vector(panels, test, "u", "mm", 1e3, &Recording::displacement);
    for (int part = 0; part < 4; ++part)
        add_panel(
            panels, test, fmt::format("q{}", "wxyz"[part]),
            [](const Recording& r) { return !r.attitude.empty(); },
            [&](const Recording& r, std::size_t k) {
                const Quat& q = r.attitude[k];
                return std::array{q.w(), q.x(), q.y(), q.z()}[static_cast<std::size_t>(part)];
            });
    const auto add_numbers = [&](const std::string& label, double scale, auto channel) {
        add_panel(
            panels, test, label, [&](const Recording& r) { return !(r.*channel).empty(); },
            [&](const Recording& r, std::size_t k) { return scale * (r.*channel)[k]; });
    };
    add_numbers("axial strain (%)", 100, &Recording::strain);
    add_numbers("load cycles", 1, &Recording::phase);
    for (const DeviceChannel& channel : device_channels())
        add_numbers(channel.column, 1, channel.values);
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

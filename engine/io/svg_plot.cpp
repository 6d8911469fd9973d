#include "engine/io/svg_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace bris {

namespace {

constexpr double width = 640, height = 400, left = 78, right = 14, top = 34, below = 52;
constexpr std::size_t colours = 7;

/// One axis: the range of numbers and the positions of the ticks.
struct Axis {
    double low = 0, high = 1; // numbers at its ends
    bool logarithmic = false;
    double from = 0, to = 1; // pixels

    double scaled(double x) const { return logarithmic ? std::log10(x) : x; }
    bool shows(double x) const { return std::isfinite(x) && (!logarithmic || x > 0); }
    double place(double x) const {
        return from + (scaled(x) - scaled(low)) / (scaled(high) - scaled(low)) * (to - from);
    }
};

Axis axis_of(const Plot& plot, std::vector<double> Curve::*values, bool logarithmic) {
    Axis axis{.low = std::numeric_limits<double>::infinity(),
              .high = -std::numeric_limits<double>::infinity(),
              .logarithmic = logarithmic};
    for (const Curve& curve : plot.curves)
        for (const double x : curve.*values)
            if (axis.shows(x)) {
                axis.low = std::min(axis.low, x);
                axis.high = std::max(axis.high, x);
            }
    if (!(axis.low <= axis.high)) { // nothing to show
        axis.low = logarithmic ? 0.1 : 0;
        axis.high = 1;
    }
    if (logarithmic) {
        if (axis.high < 1.01 * axis.low) axis.high = 10 * axis.low;
    } else if (!(axis.high - axis.low >
                 1e-12 * std::max(std::abs(axis.low), std::abs(axis.high)))) {
        const double half = axis.low == 0 ? 1 : 0.5 * std::abs(axis.low);
        axis.low -= half;
        axis.high += half;
    }
    return axis;
}

/// Leaves some room above and below the curves.
void widen(Axis& axis) {
    constexpr double room = 0.05;
    if (axis.logarithmic) {
        const double factor = std::pow(axis.high / axis.low, room);
        axis.low /= factor;
        axis.high *= factor;
    } else {
        const double more = room * (axis.high - axis.low);
        axis.low -= more;
        axis.high += more;
    }
}

std::vector<double> ticks_of(const Axis& axis) {
    std::vector<double> ticks;
    if (axis.logarithmic) {
        const double low = std::log10(axis.low), high = std::log10(axis.high);
        const double every = std::max(1.0, std::ceil((high - low) / 7));
        for (double e = std::ceil(low - 1e-9); e <= high + 1e-9; e += every)
            ticks.push_back(std::pow(10, e));
        if (ticks.size() >= 2) return ticks;
        ticks = {axis.low, axis.high};
        return ticks;
    }
    const double rough = (axis.high - axis.low) / 6,
                 unit = std::pow(10, std::floor(std::log10(rough))), part = rough / unit;
    const double step = unit * (part > 5 ? 10 : part > 2 ? 5 : part > 1 ? 2 : 1);
    const double first = std::ceil(axis.low / step - 1e-9);
    for (double k = 0; (first + k) * step <= axis.high + 1e-9 * step; ++k)
        ticks.push_back((first + k) * step);
    return ticks;
}

std::string label_of(double tick, const Axis& axis) {
    const double range = axis.logarithmic ? 0 : axis.high - axis.low;
    if (std::abs(tick) < 1e-9 * range) tick = 0;
    return fmt::format("{:.4g}", tick);
}

std::string axes(const Axis& x, const Axis& y, const Plot& plot) {
    std::string text;
    for (const double tick : ticks_of(x)) {
        const double at = x.place(tick);
        text += fmt::format("<path class=\"grid\" d=\"M{:.1f} {:.1f}V{:.1f}\"/><text x=\"{:.1f}\" "
                            "y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                            at, y.to, y.from, at, y.from + 18, label_of(tick, x));
    }
    for (const double tick : ticks_of(y)) {
        const double at = y.place(tick);
        text += fmt::format("<path class=\"grid\" d=\"M{:.1f} {:.1f}H{:.1f}\"/><text x=\"{:.1f}\" "
                            "y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                            x.from, at, x.to, x.from - 6, at + 4, label_of(tick, y));
    }
    text += fmt::format("<path class=\"axis\" d=\"M{:.1f} {:.1f}V{:.1f}H{:.1f}\"/>\n", x.from, y.to,
                        y.from, x.to);
    text += fmt::format("<text class=\"title\" x=\"{:.1f}\" y=\"18\">{}</text>\n", left,
                        escaped_for_html(plot.title));
    text += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                        (x.from + x.to) / 2, y.from + 38, escaped_for_html(plot.x_label));
    text += fmt::format("<text transform=\"translate(15 {:.1f}) rotate(-90)\" "
                        "text-anchor=\"middle\">{}</text>\n",
                        (y.from + y.to) / 2, escaped_for_html(plot.y_label));
    return text;
}

std::string line(const Curve& curve, std::size_t colour, const Axis& x, const Axis& y) {
    std::string path;
    bool drawing = false;
    for (std::size_t k = 0; k < std::min(curve.x.size(), curve.y.size()); ++k) {
        if (!x.shows(curve.x[k]) || !y.shows(curve.y[k])) {
            drawing = false;
            continue;
        }
        path += fmt::format("{}{:.1f} {:.1f}", drawing ? "L" : "M", x.place(curve.x[k]),
                            y.place(curve.y[k]));
        drawing = true;
    }
    return fmt::format("<path class=\"line c{}{}\" d=\"{}\"/>\n", colour,
                       curve.style == Curve::Style::dashed ? " dashed" : "", path);
}

std::string points(const Curve& curve, std::size_t colour, const Axis& x, const Axis& y) {
    std::string path; // a stroke without length has round ends: a dot
    for (std::size_t k = 0; k < std::min(curve.x.size(), curve.y.size()); ++k)
        if (x.shows(curve.x[k]) && y.shows(curve.y[k]))
            path += fmt::format("M{:.1f} {:.1f}h0", x.place(curve.x[k]), y.place(curve.y[k]));
    return fmt::format("<path class=\"dots c{}\" d=\"{}\"/>\n", colour, path);
}

/// A row of the key below the panel; returns its height.
std::string key_row(const Curve& curve, std::size_t colour, double at) {
    const char* const style = curve.style == Curve::Style::dashed   ? "line dashed"
                              : curve.style == Curve::Style::points ? "dots"
                                                                    : "line";
    const char* const mark = curve.style == Curve::Style::points ? "h0" : "h26";
    return fmt::format("<path class=\"{} c{}\" d=\"M{:.1f} {:.1f}{}\"/><text x=\"{:.1f}\" "
                       "y=\"{:.1f}\">{}</text>\n",
                       style, colour, left + (mark[1] == '0' ? 13 : 0), at, mark, left + 34, at + 4,
                       escaped_for_html(curve.label));
}

} // namespace

const std::string_view svg_plot_style =
    "svg.plot{width:100%;height:auto;max-width:44rem;display:block}"
    "svg.plot text{fill:var(--text);font:13px system-ui,sans-serif}"
    "svg.plot text.title{font-weight:600;font-size:14px}"
    "svg.plot .grid{stroke:var(--grid);fill:none}"
    "svg.plot .axis{stroke:var(--text);fill:none}"
    "svg.plot .line{fill:none;stroke-width:2}"
    "svg.plot .dashed{stroke-dasharray:9 5}"
    "svg.plot .dots{fill:none;stroke-width:5;stroke-linecap:round}"
    ".c0{stroke:var(--c0)}.c1{stroke:var(--c1)}.c2{stroke:var(--c2)}.c3{stroke:var(--c3)}"
    ".c4{stroke:var(--c4)}.c5{stroke:var(--c5)}.c6{stroke:var(--c6)}"
    ":root{--text:#1c1c1c;--grid:#e2e2e2;--c0:#0072b2;--c1:#d55e00;--c2:#009e73;--c3:#b3548c;"
    "--c4:#b27b00;--c5:#3487b8;--c6:#555}"
    "@media(prefers-color-scheme:dark){:root{--text:#e6e6e6;--grid:#3a3a3a;--c0:#56b4e9;"
    "--c1:#ff8a3d;--c2:#2fd3a0;--c3:#e59cc4;--c4:#f0b429;--c5:#8fd0f5;--c6:#bbb}}";

std::string escaped_for_html(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '"')
            out += "&quot;";
        else if (c == '\n' || c == '\t')
            out += ' ';
        else if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f)
            out += c;
    }
    return out;
}

std::string svg_plot(const Plot& plot) {
    Axis x = axis_of(plot, &Curve::x, plot.x_logarithmic),
         y = axis_of(plot, &Curve::y, plot.y_logarithmic);
    widen(y);
    x.from = left;
    x.to = width - right;
    y.from = height - below;
    y.to = top;
    std::string curves, key;
    std::size_t colour = 0; // a curve that is not in the key has the colour of the curve before it
    double bottom = height;
    for (std::size_t i = 0; i < plot.curves.size(); ++i) {
        const Curve& curve = plot.curves[i];
        if (i > 0 && !curve.label.empty()) colour = (colour + 1) % colours;
        curves += curve.style == Curve::Style::points ? points(curve, colour, x, y)
                                                      : line(curve, colour, x, y);
        if (curve.label.empty()) continue;
        key += key_row(curve, colour, bottom + 4);
        bottom += 20;
    }
    return fmt::format("<svg class=\"plot\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" "
                       "aria-label=\"{}\">\n{}{}{}</svg>\n",
                       width, bottom + 4, escaped_for_html(plot.title), axes(x, y, plot), curves,
                       key);
}

} // namespace bris

#include "engine/io/plot.hpp"

#include "engine/io/gnuplot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace bris {

namespace {

// Okabe and Ito (2008): distinguishable with every kind of colour vision
constexpr std::array colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                             "#e69f00", "#56b4e9", "#000000"};
constexpr std::array points{7, 5, 9, 13, 11, 6, 4};
/// The colour of the number-th curve. Beyond those above, hues about a golden angle apart, in turn
/// dark and light, so that no two of twenty curves look alike.
std::string colour_of(std::size_t number) {
    if (number < colours.size()) return colours[number];
    const double further = static_cast<double>(number - colours.size());
    const double hue = 6 * std::fmod(0.13 + 0.618034 * further, 1), value = number % 2 ? 0.9 : 0.55;
    const auto part = [&](double shift) { // of red, green and blue, 0 to 1
        const double away = std::abs(std::fmod(hue + shift, 6) - 3) - 1;
        return static_cast<int>(255 * value * (0.1 + 0.9 * std::clamp(away, 0.0, 1.0)));
    };
    return fmt::format("#{:02x}{:02x}{:02x}", part(0), part(4), part(2));
}
constexpr unsigned panel_width = 620, panel_height = 440;

const char* const look = "set border 3 linewidth 1 linecolor '#444444'\n"
                         "set tics nomirror out scale 0.6 textcolor '#222222'\n"
                         "set grid linetype 1 linecolor '#e4e4e4' linewidth 1\n"
                         "set key outside below center horizontal reverse Left samplen 2.5\n"
                         "set format '%g'\n"
                         "set lmargin 11\nset rmargin 3.5\nset tmargin 2.6\n"
                         "set autoscale xfix\n" // from the first to the last point
                         "set offsets graph 0, 0, graph 0.06, 0\n";

bool drawable(double x, bool logarithmic) { return std::isfinite(x) && (!logarithmic || x > 0); }

/// The data of a curve as a named block; returns the number of points to draw.
std::size_t append_block(std::string& text, const std::string& block, const Curve& curve,
                         const Plot& plot) {
    std::size_t count = 0;
    text += fmt::format("{} << EOD\n", block);
    for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
        const bool good =
            drawable(curve.x[i], plot.x_logarithmic) && drawable(curve.y[i], plot.y_logarithmic);
        count += good ? 1u : 0u;
        text += good ? fmt::format("{} {}\n", curve.x[i], curve.y[i]) : std::string("\n");
    }
    text += "EOD\n";
    return count;
}

std::string style_of(Curve::Style style, std::size_t i) {
    const std::string colour = colour_of(i);
    if (style == Curve::Style::points)
        return fmt::format("with points pointtype {} pointsize 0.9 linewidth 1.5 linecolor '{}'",
                           points[i % points.size()], colour);
    return fmt::format("with lines linewidth 2 dashtype {} linecolor '{}'",
                       style == Curve::Style::dashed ? "(10,5)" : "solid", colour);
}

/// Height below the axes in lines of text: tics, label, and the rows of the key, whose columns are
/// as wide as the longest label.
double bottom_margin(const Plot& plot) {
    std::size_t entries = 0, longest = 1;
    for (const Curve& curve : plot.curves) {
        if (curve.label.empty()) continue;
        ++entries;
        longest = std::max(longest, curve.label.size());
    }
    constexpr std::size_t width = 60, sample = 9; // characters, as gnuplot counts them
    const std::size_t columns = std::max<std::size_t>(1, width / (longest + sample));
    const std::size_t rows = (entries + columns - 1) / columns;
    return 6.2 + 1.1 * static_cast<double>(rows > 2 ? rows - 2 : 0);
}

std::string panel(const Plot& plot, std::size_t number) {
    std::string text;
    std::string curves;
    std::size_t colour = 0; // a curve that is not in the key has the colour of the curve before it
    for (std::size_t i = 0; i < plot.curves.size(); ++i) {
        const Curve& curve = plot.curves[i];
        if (i > 0 && !curve.label.empty()) ++colour;
        const std::string block = fmt::format("$curve_{}_{}", number, i);
        const std::size_t count = append_block(text, block, curve, plot);
        if (count == 0) continue;
        const std::string title =
            curve.label.empty() ? "notitle" : "title " + gnuplot_quoted(curve.label);
        curves +=
            fmt::format("{}{} using 1:2 {} {}", curves.empty() ? "" : ", ", block,
                        style_of(count == 1 ? Curve::Style::points : curve.style, colour), title);
    }
    text +=
        fmt::format("set title {} font ',12'\nset xlabel {}\nset ylabel {}\nset bmargin {:.1f}\n",
                    gnuplot_quoted(plot.title), gnuplot_quoted(plot.x_label),
                    gnuplot_quoted(plot.y_label), bottom_margin(plot));
    const bool empty = curves.empty(); // an empty panel still shows its title and axes
    text += plot.x_logarithmic && !empty ? "set logscale x\n" : "unset logscale x\n";
    text += plot.y_logarithmic && !empty ? "set logscale y\n" : "unset logscale y\n";
    if (empty) return text + "plot [0:1] [0:1] NaN notitle\n";
    return text + "plot " + curves + "\n";
}

} // namespace

bool draw_plots(const std::filesystem::path& png, const std::vector<Plot>& panels,
                unsigned columns) {
    const auto count = static_cast<unsigned>(std::max<std::size_t>(panels.size(), 1));
    if (columns == 0) columns = std::min(count, 3u);
    const unsigned rows = (count + columns - 1) / columns;
    std::string text = look;
    text += fmt::format("set multiplot layout {},{}\n", rows, columns);
    for (std::size_t i = 0; i < panels.size(); ++i) text += panel(panels[i], i);
    text += "unset multiplot\n";
    return draw_with_gnuplot(png, columns * panel_width, rows * panel_height, text);
}

} // namespace bris

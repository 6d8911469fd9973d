#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// A line of a plot; points for what was measured elsewhere. NaN leaves a gap.
struct Curve {
    enum class Style { line, dashed, points };
    std::string label = ""; ///< empty: not in the key, in the colour of the curve before it
    std::vector<double> x = {};
    std::vector<double> y = {};
    Style style = Style::line;
};

/// One panel.
struct Plot {
    std::string title = "";
    std::string x_label = ""; ///< with its unit, as "axial strain (%)"
    std::string y_label = "";
    std::vector<Curve> curves = {};
    bool x_logarithmic = false;
    bool y_logarithmic = false;
};

/// Draws the panels side by side into one PNG through gnuplot, `columns` to a row (0: all in one,
/// at most three). Returns false, with one line on stderr, if that is impossible.
bool draw_plots(const std::filesystem::path& png, const std::vector<Plot>& panels,
                unsigned columns = 0);

} // namespace bris

#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// One curve of a plot; points show data from other sources. NaN leaves a gap.
struct Curve {
    enum class Style { line, dashed, points };
    /// Empty: not in the key, and drawn in the colour of the curve before it.
    std::string label = "";
    std::vector<double> x = {};
    std::vector<double> y = {};
    Style style = Style::line;
};

/// One panel of a figure.
struct Plot {
    std::string title = "";
    std::string x_label = ""; ///< with its unit, as in "axial strain (%)"
    std::string y_label = "";
    std::vector<Curve> curves = {};
    bool x_logarithmic = false;
    bool y_logarithmic = false;
};

/// Draws the panels into one PNG with gnuplot, `columns` per row (0: up to three). If that is
/// impossible, prints one line to stderr and returns false.
bool draw_plots(const std::filesystem::path& png, const std::vector<Plot>& panels,
                unsigned columns = 0);

} // namespace bris

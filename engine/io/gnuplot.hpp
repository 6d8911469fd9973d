#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace bris {

/// Draws `png`, width by height pixels, with gnuplot: `commands`, then `data`, which the last
/// command reads from '-'. The picture replaces an older one only when it is complete. If gnuplot
/// is missing or fails, prints the reason in one line to stderr and returns false: a missing
/// picture never ends a run.
bool draw_with_gnuplot(const std::filesystem::path& png, unsigned width, unsigned height,
                       std::string_view commands, std::string_view data = {});

/// The text in quotes for gnuplot.
std::string gnuplot_quoted(const std::string& text);

} // namespace bris

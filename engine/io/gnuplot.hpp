#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace bris {

/// Lets gnuplot draw `png`, width by height pixels: `commands`, then `data` (what the last command
/// reads from '-'). The picture replaces an older one when it is complete. Returns false, and says
/// why in one line on stderr, if gnuplot is missing or fails: a run never ends for a picture.
bool draw_with_gnuplot(const std::filesystem::path& png, unsigned width, unsigned height,
                       std::string_view commands, std::string_view data = {});

/// Text in gnuplot's quotes.
std::string gnuplot_quoted(const std::string& text);

} // namespace bris

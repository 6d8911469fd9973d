#pragma once

#include "engine/io/plot.hpp"

#include <string>
#include <string_view>

namespace bris {

/// A panel as an SVG element for an HTML page, as wide as its place. Colours are those of
/// svg_plot_style, so that the panel follows the colours of the page.
std::string svg_plot(const Plot& plot);

/// Rules of CSS for svg_plot, for light and dark pages: Okabe and Ito (2008), distinguishable with
/// every kind of colour vision.
extern const std::string_view svg_plot_style;

/// The text with the characters that HTML and SVG reserve replaced, and control characters left
/// out.
std::string escaped_for_html(std::string_view text);

} // namespace bris

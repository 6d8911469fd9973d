#include "systems/output/picture.hpp"

#include "engine/io/gnuplot.hpp"
#include "engine/random.hpp"
#include "engine/ranks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace bris {

namespace {

constexpr unsigned caption_height = 44, gap = 24; // pixels

std::uint8_t level(double x) { return static_cast<std::uint8_t>(std::clamp(x, 0.0, 255.0)); }

/// Copies `part` into `whole` with its upper left corner at (left, top).
void paste(const Image& part, unsigned left, unsigned top, Image& whole) {
    for (unsigned y = 0; y < part.height; ++y)
        std::copy_n(part.rgb.begin() + std::ptrdiff_t{3} * y * part.width, 3 * part.width,
                    whole.rgb.begin() + std::ptrdiff_t{3} * ((top + y) * whole.width + left));
}

} // namespace

bool draw_picture(const std::filesystem::path& png, std::span<const View> views,
                  const Camera& camera, unsigned height) {
    if (!Ranks::writes()) return true; // and others have no balls
    const PictureWindow window = window_around(views, camera);
    const bool captions = std::any_of(views.begin(), views.end(),
                                      [](const View& view) { return !view.caption.empty(); });
    const unsigned top = captions ? caption_height : 0;
    constexpr double widest = 2400; // pixels of a view
    height = static_cast<unsigned>(
        std::clamp(widest * window.height / window.width, 1.0, static_cast<double>(height)));
    if (views.empty()) return false;
    Image whole;
    std::string labels;
    unsigned left = 0;
    for (const View& view : views) {
        const Image image = render(view, camera, window, height); // all are equally wide
        if (left == 0) {
            const auto count = static_cast<unsigned>(views.size());
            whole = {.width = count * (image.width + gap) - gap, .height = height + top, .rgb = {}};
            whole.rgb.assign(std::size_t{3} * whole.width * whole.height, 255);
        }
        if (!view.caption.empty())
            labels += fmt::format("set label {} at {},{} center font ',18' front\n",
                                  gnuplot_quoted(view.caption), left + image.width / 2,
                                  caption_height / 2);
        paste(image, left, top, whole);
        left += image.width + gap;
    }
    // one unit of the plot is one pixel of the image; rows run downwards in both
    const std::string commands =
        fmt::format("set margins 0,0,0,0\nunset border\nunset tics\nunset key\n{}"
                    "plot [-0.5:{}-0.5] [{}-0.5:-0.5] '-' binary array=({},{}) format='%uchar' "
                    "with rgbimage\n",
                    labels, whole.width, whole.height, whole.width, whole.height);
    const std::string_view data(reinterpret_cast<const char*>(whole.rgb.data()), whole.rgb.size());
    return draw_with_gnuplot(png, whole.width, whole.height, commands, data);
}

Colour rock_colour(std::uint32_t id) {
    Random random(0x57, id);
    const double light = random.uniform(150, 225), warm = random.uniform(-6, 26);
    return {level(light + 0.6 * warm), level(light), level(light - warm)};
}

Colour scale_colour(double fraction) {
    static constexpr double nodes[5][3] = {
        {0, 34, 78}, {66, 78, 108}, {124, 123, 120}, {187, 175, 113}, {254, 232, 56}};
    const double at = 4 * (std::isfinite(fraction) ? std::clamp(fraction, 0.0, 1.0) : 0.0);
    const auto i = static_cast<std::size_t>(std::min(at, 3.0));
    const double t = at - static_cast<double>(i);
    const auto mix = [&](int k) {
        return level((1 - t) * nodes[i][k] + t * nodes[i + 1][k] + 0.5);
    };
    return {mix(0), mix(1), mix(2)};
}

} // namespace bris

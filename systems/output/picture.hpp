#pragma once

#include "engine/math.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace bris {

struct Colour {
    std::uint8_t red = 0, green = 0, blue = 0;
};

/// A sphere as it is drawn, m. Neighbouring balls of one colour look like one body.
struct DrawnBall {
    Vec3 centre = Vec3::Zero();
    double radius = 0;
    Colour colour;
};

/// What one view shows: balls, and quads as outlines (corners in order).
struct View {
    std::vector<DrawnBall> balls = {};
    std::vector<std::array<Vec3, 4>> quads = {};
    std::string caption = "";
};

/// Looks horizontally along -y at azimuth 0, turned about z and raised (rad). No perspective.
struct Camera {
    double azimuth = 0.5;
    double elevation = 0.25;
};

/// The part of the picture plane that is shown: its middle (m, right and up) and its scale.
struct Window {
    double middle_right = 0, middle_up = 0; // m
    double width = 1, height = 1;           // m
};

/// Rows from top to bottom, red, green, blue.
struct Image {
    unsigned width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
};

/// A window that shows all the views at one scale, with a small margin.
Window window_around(std::span<const View> views, const Camera& camera);

/// Draws a view on white, `height` pixels high, the width in proportion: z-buffer, two by two
/// samples a pixel, light from the upper left, dark edges. 120 000 balls on 1200 rows: about 1 s.
Image render(const View& view, const Camera& camera, const Window& window, unsigned height);

/// All views side by side at one scale, captions above, as a PNG through gnuplot. Returns false,
/// with one line on stderr, if that is impossible.
bool draw_picture(const std::filesystem::path& png, std::span<const View> views,
                  const Camera& camera = {}, unsigned height = 1200);

/// A stone's colour: greys and browns, another one for each id.
Colour rock_colour(std::uint32_t id);

/// Colour of a quantity between 0 (dark blue) and 1 (yellow); safe for colour-blind readers
/// (cividis: Nunez, Anderton and Renslow 2018).
Colour scale_colour(double fraction);

} // namespace bris

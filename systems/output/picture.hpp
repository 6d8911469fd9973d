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

/// A sphere to be drawn, m. Adjacent balls of one colour look like one body.
struct DrawnBall {
    Vec3 centre = Vec3::Zero();
    double radius = 0;
    Colour colour;
};

/// Content of one view: balls, and quads drawn as outlines (corners in order).
struct View {
    std::vector<DrawnBall> balls = {};
    std::vector<std::array<Vec3, 4>> quads = {};
    std::string caption = "";
};

/// Viewing direction (rad): +y at azimuth 0 and elevation 0; azimuth rotates about z, elevation
/// raises the camera. No perspective.
struct Camera {
    double azimuth = 0.5;
    double elevation = 0.25;
};

/// The part of the picture plane that is shown: its middle (m, to the right and upwards) and its
/// size (m).
struct PictureWindow {
    double middle_right = 0, middle_up = 0; // m
    double width = 1, height = 1;           // m
};

/// Pixels row by row from top to bottom, each red, green, blue.
struct Image {
    unsigned width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
};

/// A window that contains all views, with a small margin.
PictureWindow window_around(std::span<const View> views, const Camera& camera);

/// Draws a view on a white background, `height` pixels high and proportionally wide: z-buffer, two
/// by two samples per pixel, light from the upper left, dark edges. 120 000 balls on 1200 rows take
/// about 1 s.
Image render(const View& view, const Camera& camera, const PictureWindow& window, unsigned height);

/// Writes all views side by side at one scale, with captions above, as a PNG through gnuplot. Views
/// that would be wider than 2400 pixels are less high. If this is impossible, prints one line on
/// stderr and returns false. Only the first rank draws.
bool draw_picture(const std::filesystem::path& png, std::span<const View> views,
                  const Camera& camera = {}, unsigned height = 1200);

/// Colour of a rock: a grey or brown that depends on its id.
Colour rock_colour(std::uint32_t id);

/// Colour of a quantity between 0 (dark blue) and 1 (yellow), legible to colour-blind readers
/// (cividis: Nunez, Anderton and Renslow 2018).
Colour scale_colour(double fraction);

} // namespace bris

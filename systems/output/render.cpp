#include "systems/output/picture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

constexpr unsigned samples = 2; // per pixel and direction
constexpr float infinitely_far = std::numeric_limits<float>::max();
constexpr std::uint32_t nothing = std::numeric_limits<std::uint32_t>::max();

/// Axes of the picture: right, up, and away from the viewer.
struct Axes {
    explicit Axes(const Camera& camera) {
        const double c = std::cos(camera.azimuth), s = std::sin(camera.azimuth);
        const double e = std::cos(camera.elevation), f = std::sin(camera.elevation);
        right = Vec3(c, s, 0);
        away = Vec3(-s * e, c * e, -f);
        up = right.cross(away);
    }
    Vec3 right, up, away;
};

/// Nearest surface at every sample of some rows of a picture: its depth and its ball.
struct Depths {
    unsigned width, height;
    double scale;            // samples per m
    double left, top;        // m
    double slack;            // samples, by which a line may be behind a ball that does not hide it
    float nearest, farthest; // of all balls
    std::vector<float> depth = {};
    std::vector<std::uint32_t> ball = {};
};

/// A ball in units of samples.
struct Disc {
    float x, y, depth, radius;
};

Disc disc_of(const DrawnBall& ball, const Axes& axes, const Depths& target) {
    return {.x = static_cast<float>((ball.centre.dot(axes.right) - target.left) * target.scale),
            .y = static_cast<float>((target.top - ball.centre.dot(axes.up)) * target.scale),
            .depth = static_cast<float>(ball.centre.dot(axes.away) * target.scale),
            .radius = static_cast<float>(ball.radius * target.scale)};
}

/// First sample whose middle is at or beyond x, clamped to the picture.
unsigned first_sample(float x, unsigned size) {
    return static_cast<unsigned>(std::clamp(std::ceil(x - 0.5f), 0.0f, static_cast<float>(size)));
}

void cover(const Disc& disc, std::uint32_t index, Depths& target) {
    const unsigned bottom = first_sample(disc.y + disc.radius, target.height);
    for (unsigned row = first_sample(disc.y - disc.radius, target.height); row < bottom; ++row) {
        const float dy = static_cast<float>(row) + 0.5f - disc.y;
        const float left = disc.radius * disc.radius - dy * dy;
        const float half = std::sqrt(std::max(left, 0.0f));
        const unsigned begin = first_sample(disc.x - half, target.width);
        const unsigned end = first_sample(disc.x + half, target.width);
        float* const depth = target.depth.data() + std::size_t{row} * target.width;
        std::uint32_t* const ball = target.ball.data() + std::size_t{row} * target.width;
        for (unsigned i = begin; i < end; ++i) {
            const float dx = static_cast<float>(static_cast<int>(i)) + 0.5f - disc.x;
            const float near = disc.depth - std::sqrt(std::max(left - dx * dx, 0.0f));
            const bool nearer = near < depth[i];
            depth[i] = nearer ? near : depth[i];
            ball[i] = nearer ? index : ball[i];
        }
    }
}

bool same(const Colour& a, const Colour& b) {
    return a.red == b.red && a.green == b.green && a.blue == b.blue;
}

/// Factor of brightness: 1, or less at the edge of a body, where an adjacent sample shows another
/// body or none.
float edge_light(const Depths& depths, const std::vector<DrawnBall>& balls, std::size_t at,
                 unsigned x, unsigned y) {
    const std::uint32_t here = depths.ball[at];
    const auto beyond = [&](std::size_t other) {
        const std::uint32_t there = depths.ball[other];
        return there != here &&
               (there == nothing || !same(balls[there].colour, balls[here].colour));
    };
    const std::size_t width = depths.width;
    const bool edge = (x > 0 && beyond(at - 1)) || (x + 1 < depths.width && beyond(at + 1)) ||
                      (y > 0 && beyond(at - width)) ||
                      (y + 1 < depths.height && beyond(at + width));
    return edge ? 0.45f : 1.0f;
}

/// Brightness of the surface at a sample: ambient and diffuse light, darker at the rim and with
/// distance.
float brightness(const Disc& disc, const Depths& depths, std::size_t at, unsigned x, unsigned y) {
    const float nx = (static_cast<float>(x) + 0.5f - disc.x) / disc.radius;
    const float ny = (disc.y - static_cast<float>(y) - 0.5f) / disc.radius;
    const float nz = (disc.depth - depths.depth[at]) / disc.radius; // towards the viewer
    const float diffuse = std::max(-0.40f * nx + 0.62f * ny + 0.67f * nz, 0.0f);
    const float rim = 0.70f + 0.30f * std::min(2.2f * nz, 1.0f);
    const float span = std::max(depths.farthest - depths.nearest, 1.0f);
    const float haze = 1.0f - 0.30f * (depths.depth[at] - depths.nearest) / span;
    return (0.34f + 0.72f * diffuse) * rim * haze;
}

/// Colour of every sample, three numbers each; white where there is no ball.
std::vector<float> shade(const Depths& depths, const std::vector<DrawnBall>& balls,
                         const std::vector<Disc>& discs) {
    std::vector<float> light(3 * depths.ball.size(), 255.0f);
    for (unsigned y = 0; y < depths.height; ++y)
        for (unsigned x = 0; x < depths.width; ++x) {
            const std::size_t at = std::size_t{y} * depths.width + x;
            const std::uint32_t ball = depths.ball[at];
            if (ball == nothing) continue;
            const float b =
                brightness(discs[ball], depths, at, x, y) * edge_light(depths, balls, at, x, y);
            const Colour& colour = balls[ball].colour;
            light[3 * at] = std::min(b * static_cast<float>(colour.red), 255.0f);
            light[3 * at + 1] = std::min(b * static_cast<float>(colour.green), 255.0f);
            light[3 * at + 2] = std::min(b * static_cast<float>(colour.blue), 255.0f);
        }
    return light;
}

/// Colours a sample dark blue unless a ball is in front of it.
void stain(unsigned x, unsigned y, double depth, const Depths& depths, std::vector<float>& light) {
    if (x >= depths.width || y >= depths.height) return;
    const std::size_t at = std::size_t{y} * depths.width + x;
    if (depth > static_cast<double>(depths.depth[at]) + depths.slack) return;
    constexpr float line[3] = {20, 60, 120};
    for (std::size_t k = 0; k < 3; ++k) light[3 * at + k] += 0.5f * (line[k] - light[3 * at + k]);
}

/// A thin line between two points.
void draw_line(const Vec3& from, const Vec3& to, const Axes& axes, const Depths& depths,
               std::vector<float>& light) {
    const Vec3 edge = to - from;
    const double length = depths.scale * std::hypot(edge.dot(axes.right), edge.dot(axes.up));
    const auto steps = static_cast<unsigned>(std::ceil(std::min(length, 1e5))) + 1;
    for (unsigned i = 0; i <= steps; ++i) {
        const Vec3 at = from + edge * (static_cast<double>(i) / steps);
        const double x = (at.dot(axes.right) - depths.left) * depths.scale;
        const double y = (depths.top - at.dot(axes.up)) * depths.scale;
        if (!(x >= 0 && y >= 0 && x < depths.width && y < depths.height)) continue;
        const auto column = static_cast<unsigned>(x), row = static_cast<unsigned>(y);
        const double depth = at.dot(axes.away) * depths.scale;
        for (unsigned k = 0; k < samples * samples; ++k) // the line is one pixel wide
            stain(column + k % samples, row + k / samples, depth, depths, light);
    }
}

/// Averages the samples of rows of an image; those of the first row begin at `light`.
void average(const float* light, std::size_t first, std::size_t rows, Image& image) {
    const std::size_t width = image.width;
    for (std::size_t y = 0; y < rows; ++y)
        for (std::size_t x = 0; x < width; ++x)
            for (std::size_t k = 0; k < 3; ++k) {
                float sum = 0;
                for (std::size_t j = 0; j < samples; ++j)
                    for (std::size_t i = 0; i < samples; ++i)
                        sum +=
                            light[3 * ((samples * y + j) * samples * width + samples * x + i) + k];
                image.rgb[3 * ((first + y) * width + x) + k] =
                    static_cast<std::uint8_t>(std::lround(sum / (samples * samples)));
            }
}

/// Draws what is seen in the rows of samples of `target`.
std::vector<float> draw(const View& view, const Axes& axes, Depths& target) {
    const std::size_t size = std::size_t{target.width} * target.height;
    target.depth.assign(size, infinitely_far);
    target.ball.assign(size, nothing);
    std::vector<Disc> discs;
    discs.reserve(view.balls.size());
    for (const DrawnBall& ball : view.balls) discs.push_back(disc_of(ball, axes, target));
    for (std::uint32_t i = 0; i < discs.size(); ++i) cover(discs[i], i, target);
    std::vector<float> light = shade(target, view.balls, discs);
    for (const auto& quad : view.quads)
        for (std::size_t i = 0; i < 4; ++i)
            draw_line(quad[i], quad[(i + 1) % 4], axes, target, light);
    return light;
}

} // namespace

PictureWindow window_around(std::span<const View> views, const Camera& camera) {
    const Axes axes(camera);
    constexpr double huge = std::numeric_limits<double>::max();
    double left = huge, right = -huge, low = huge, high = -huge;
    const auto include = [&](const Vec3& x, double radius) {
        left = std::min(left, x.dot(axes.right) - radius);
        right = std::max(right, x.dot(axes.right) + radius);
        low = std::min(low, x.dot(axes.up) - radius);
        high = std::max(high, x.dot(axes.up) + radius);
    };
    for (const View& view : views) {
        for (const DrawnBall& ball : view.balls) include(ball.centre, ball.radius);
        for (const auto& quad : view.quads)
            for (const Vec3& corner : quad) include(corner, 0);
    }
    if (left > right) return {};
    const double margin = 0.02 * std::max({right - left, high - low, 1e-9});
    return {.middle_right = (left + right) / 2,
            .middle_up = (low + high) / 2,
            .width = right - left + 2 * margin,
            .height = high - low + 2 * margin};
}

Image render(const View& view, const Camera& camera, const PictureWindow& window, unsigned height) {
    const Axes axes(camera);
    const auto width = static_cast<unsigned>(
        std::clamp(std::lround(height * window.width / window.height), 1l, 20000l));
    Image image{.width = width, .height = height, .rgb = {}};
    image.rgb.resize(std::size_t{3} * width * height);
    const double scale = samples * height / window.height;
    float nearest = infinitely_far, farthest = -infinitely_far;
    for (const DrawnBall& ball : view.balls) {
        const double depth = ball.centre.dot(axes.away) * scale;
        nearest = std::min(nearest, static_cast<float>(depth - ball.radius * scale));
        farthest = std::max(farthest, static_cast<float>(depth));
    }
    // in strips, because the samples of a pixel take 80 bytes
    constexpr unsigned rows_of_strip = 16, margin = 1;
    for (unsigned first = 0; first < height; first += rows_of_strip) {
        const unsigned rows = std::min(rows_of_strip, height - first);
        const double above = static_cast<double>(first) - margin; // rows
        Depths strip{.width = samples * width,
                     .height = samples * (rows + 2 * margin),
                     .scale = scale,
                     .left = window.middle_right - window.width / 2,
                     .top = window.middle_up + window.height / 2 - above * samples / scale,
                     // a ball that touches the membrane from inside does not hide its line
                     .slack = 0.004 * samples * height,
                     .nearest = nearest,
                     .farthest = farthest};
        const std::vector<float> light = draw(view, axes, strip);
        average(light.data() + std::size_t{3} * strip.width * samples * margin, first, rows, image);
    }
    return image;
}

} // namespace bris

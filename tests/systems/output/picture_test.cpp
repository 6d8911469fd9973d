#include "engine/io/whole_file.hpp"
#include "systems/output/picture.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cstdlib>

using namespace bris;

namespace {

struct Rgb {
    int red, green, blue;
};

Rgb pixel(const Image& image, unsigned x, unsigned y) {
    const std::size_t at = 3 * (std::size_t{y} * image.width + x);
    return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

/// Fraction of the picture that is not white.
double covered(const Image& image) {
    std::size_t count = 0;
    for (unsigned y = 0; y < image.height; ++y)
        for (unsigned x = 0; x < image.width; ++x) {
            const Rgb p = pixel(image, x, y);
            count += p.red + p.green + p.blue < 3 * 255 ? 1 : 0;
        }
    return static_cast<double>(count) / (static_cast<double>(image.width) * image.height);
}

constexpr Camera level{.azimuth = 0, .elevation = 0};
constexpr PictureWindow square{.middle_right = 0, .middle_up = 0, .width = 2, .height = 2};

bool gnuplot_missing() { return std::system("command -v gnuplot >/dev/null 2>&1") != 0; }

} // namespace

TEST_SUITE("output/picture") {
    TEST_CASE("a ball covers the area of its disc") {
        // a rim of partly covered pixels adds about half a pixel to the radius of 200: under 1 %
        const View view{
            .balls = {{.centre = Vec3(0.1, 3, -0.2), .radius = 0.5, .colour = {200, 0, 0}}}};
        for (const Camera& camera : {level, Camera{.azimuth = 1, .elevation = 0.4}}) {
            PictureWindow window = window_around(std::vector<View>{view}, camera);
            window.width = window.height = 2;
            const Image image = render(view, camera, window, 800);
            CHECK(image.width == 800);
            CHECK(covered(image) == about(pi * 0.25 / 4).epsilon(0.02));
        }
    }

    TEST_CASE("the nearer ball hides the farther one in any order of the balls") {
        const DrawnBall near{.centre = Vec3(0, -1, 0), .radius = 0.3, .colour = {255, 0, 0}};
        const DrawnBall far{.centre = Vec3(0, 1, 0), .radius = 0.6, .colour = {0, 0, 255}};
        for (const auto& balls :
             {std::vector<DrawnBall>{near, far}, std::vector<DrawnBall>{far, near}}) {
            const Image image = render({.balls = balls}, level, square, 200);
            const Rgb middle = pixel(image, 100, 100);
            CHECK(middle.red > 100);
            CHECK(middle.blue == 0);
            const Rgb beside = pixel(image, 100, 55); // 0.45 m above the middle
            CHECK(beside.red == 0);
            CHECK(beside.blue > 50);
        }
    }

    TEST_CASE("right is +x and up is +z for a camera at azimuth 0") {
        const View view{
            .balls = {{.centre = Vec3(0.5, 0, 0.5), .radius = 0.2, .colour = {255, 0, 0}}}};
        const Image image = render(view, level, square, 200);
        CHECK(pixel(image, 150, 50).green < 50);
        CHECK(pixel(image, 50, 150).green == 255);
    }

    TEST_CASE("a quad is drawn as an outline, which balls in front of it hide") {
        const std::array<Vec3, 4> quad{Vec3(-0.8, 0, -0.8), Vec3(0.8, 0, -0.8), Vec3(0.8, 0, 0.8),
                                       Vec3(-0.8, 0, 0.8)};
        const DrawnBall ball{.centre = Vec3(-0.8, -1, 0), .radius = 0.15, .colour = {255, 255, 0}};
        const Image image = render({.balls = {ball}, .quads = {quad}}, level, square, 200);
        CHECK(pixel(image, 100, 100).blue == 255); // the middle is open
        int darkest = 255;
        for (unsigned x = 176; x < 184; ++x) darkest = std::min(darkest, pixel(image, x, 100).red);
        CHECK(darkest < 180);
        for (unsigned x = 16; x < 24; ++x) CHECK(pixel(image, x, 100).blue == 0); // under the ball
    }

    TEST_CASE("an empty scene is white") {
        const View view;
        CHECK(covered(render(view, level, window_around(std::vector<View>{view}, level), 50)) == 0);
    }

    TEST_CASE("views are drawn side by side in one picture file") {
        if (gnuplot_missing()) {
            MESSAGE("skipped: gnuplot is not installed");
            return;
        }
        const TemporaryDirectory directory;
        const View view{.balls = {{.centre = Vec3::Zero(), .radius = 1, .colour = {200, 100, 0}}},
                        .caption = "4 % (it's \"half\")"};
        CHECK(draw_picture(directory / "new" / "a.png", std::vector<View>{view, view}, level, 100));
        const std::string png = read_whole(directory / "new" / "a.png");
        CHECK(png.starts_with("\x89PNG"));
        const auto size = [&](std::size_t at) {
            return static_cast<unsigned char>(png[at + 2]) * 256 +
                   static_cast<unsigned char>(png[at + 3]);
        };
        CHECK(size(16) == 224); // two of 100 and a gap of 24
        CHECK(size(20) == 144); // a caption of 44 above
        CHECK(std::distance(std::filesystem::directory_iterator(directory / "new"), {}) == 1);
        CHECK_FALSE(draw_picture("/proc/none/a.png", std::vector<View>{view}, level, 50));
    }
}

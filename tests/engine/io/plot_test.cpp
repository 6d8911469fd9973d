#include "engine/io/plot.hpp"
#include "engine/io/whole_file.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cstdlib>
#include <limits>

using namespace bris;

namespace {

bool gnuplot_missing() { return std::system("command -v gnuplot >/dev/null 2>&1") != 0; }

Plot sample() {
    const double gap = std::numeric_limits<double>::quiet_NaN();
    return {.title = "It's \"q\" of $x_1$",
            .x_label = "axial strain (%)",
            .y_label = "q (kPa)",
            .curves = {{.label = "simulated", .x = {0, 1, 2, 3}, .y = {0, 5, gap, 7}},
                       {.label = "", .x = {1, 2}, .y = {4, 5}, .style = Curve::Style::points},
                       {.label = "nothing", .x = {}, .y = {}, .style = Curve::Style::dashed}}};
}

int pixels(const std::string& png, std::size_t at) {
    return static_cast<unsigned char>(png[at + 2]) * 256 + static_cast<unsigned char>(png[at + 3]);
}

} // namespace

TEST_SUITE("engine/io/plot") {
    TEST_CASE("panels are drawn side by side or below each other in one picture") {
        if (gnuplot_missing()) {
            MESSAGE("skipped: gnuplot is not installed");
            return;
        }
        const TemporaryDirectory directory;
        Plot logarithmic = sample();
        logarithmic.x_logarithmic = logarithmic.y_logarithmic = true; // drops x = 0
        CHECK(draw_plots(directory / "new" / "a.png", {sample(), logarithmic}));
        const std::string png = read_whole(directory / "new" / "a.png");
        CHECK(png.starts_with("\x89PNG"));
        CHECK(pixels(png, 16) == 2 * 620);
        CHECK(pixels(png, 20) == 440);
        CHECK(draw_plots(directory / "new" / "b.png", {sample(), sample()}, 1));
        CHECK(pixels(read_whole(directory / "new" / "b.png"), 20) == 2 * 440);
        // no temporary file is left
        CHECK(std::distance(std::filesystem::directory_iterator(directory / "new"), {}) == 2);
    }

    TEST_CASE("panels without data, and a figure without panels, do not end a run") {
        const TemporaryDirectory directory;
        const bool possible = !gnuplot_missing();
        CHECK(draw_plots(directory / "a.png", {Plot{}}) == possible);
        CHECK(draw_plots(directory / "b.png", {}) == possible);
    }

    TEST_CASE("without gnuplot, or if the folder is not writable, no picture is written") {
        CHECK_FALSE(draw_plots("/proc/none/a.png", {sample()}));
        const TemporaryDirectory directory;
        const char* const path = std::getenv("PATH");
        const std::string before = path ? path : "";
        setenv("PATH", directory.path().c_str(), 1);
        CHECK_FALSE(draw_plots(directory / "a.png", {sample()}));
        setenv("PATH", before.c_str(), 1);
        CHECK(std::filesystem::is_empty(directory.path()));
    }
}

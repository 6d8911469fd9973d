#include "engine/io/base64.hpp"
#include "engine/io/html_page.hpp"
#include "engine/io/svg_plot.hpp"
#include "engine/io/whole_file.hpp"
#include "tests/engine/io/html_text.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

using namespace bris;

using testing::count, testing::fetched_by, testing::is_balanced;

TEST_SUITE("engine/io/html_page") {
    TEST_CASE("a page is whole, escapes its texts and needs nothing from elsewhere") {
        const double nan = std::numeric_limits<double>::quiet_NaN();
        HtmlPage page("a < b & \"c\"");
        page.heading("<script>");
        page.verdict("bad", "changed", "sensor 3");
        page.table({{"sensor", "share"}, {"1", "20 %"}}, {"good"});
        page.begin_details("more");
        page.plot({.title = "p",
                   .curves = {{"line", {1, 2, nan, 4}, {1, 0.1, 3, 1e-3}},
                              {"none", {nan}, {nan}, Curve::Style::points}},
                   .y_logarithmic = true});
        page.end_details();
        const TemporaryDirectory directory;
        page.write(directory / "p.html");
        const std::string html = read_whole(directory / "p.html");
        CHECK(is_balanced(html));
        CHECK(html.find("a &lt; b &amp; &quot;c&quot;") != std::string::npos);
        CHECK(fetched_by(html).empty());
        CHECK(html.find("nan") == std::string::npos);
        CHECK(html.find("prefers-color-scheme:dark") != std::string::npos);
        CHECK(html.find("width=device-width") != std::string::npos);
    }

    TEST_CASE("pictures are within a page, links lead to files beside it, commands stay as typed") {
        const std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\2\x58\0\0\1\0", 24);
        HtmlPage page("p");
        page.picture("a \"b\"", png);
        page.links({{"javascript:alert(1)", "<i>"}, {"110kPa/a b&\".csv", "table"}});
        page.command("bris run 'x<y'");
        const std::string html = page.text();
        CHECK(is_balanced(html));
        CHECK(fetched_by(html).empty());
        CHECK(html.find("<img alt=\"a &quot;b&quot;\" width=\"600\" height=\"256\" "
                        "src=\"data:image/png;base64," +
                        to_base64(png) + "\">") != std::string::npos);
        CHECK(html.find(
                  "<a href=\"./javascript%3Aalert%281%29\">javascript:alert(1)</a> &lt;i&gt;") !=
              std::string::npos);
        CHECK(html.find("href=\"./110kPa/a%20b%26%22.csv\"") != std::string::npos);
        CHECK(html.find("<pre>bris run 'x&lt;y'</pre>") != std::string::npos);
    }

    TEST_CASE("a curve is interrupted where it has no number") {
        const double nan = std::numeric_limits<double>::quiet_NaN();
        const std::string svg = svg_plot({.curves = {{"", {0, 1, 2, 3, 4}, {0, 1, nan, 1, 0}}}});
        const auto begin = svg.find("class=\"line"), end = svg.find("/>", begin);
        const std::string path = svg.substr(begin, end - begin);
        CHECK(count(path, "M") == 2);
        CHECK(count(path, "L") == 2);
    }

    TEST_CASE("a plot of a constant, of one point or of nothing has axes with numbers") {
        for (const std::vector<double>& y : {std::vector<double>{}, {3.0}, {2.0, 2.0}, {0.0, 0.0}})
            for (const bool logarithmic : {false, true}) {
                const std::string svg =
                    svg_plot({.curves = {{"y", std::vector<double>(y.size(), 1.0), y}},
                              .x_logarithmic = logarithmic,
                              .y_logarithmic = logarithmic});
                CHECK(is_balanced(svg));
                CHECK(count(svg, "class=\"grid\"") >= 4);
                CHECK(svg.find("nan") == std::string::npos);
                CHECK(svg.find("inf") == std::string::npos);
            }
    }

    TEST_CASE("points lie where their numbers are on the axes") {
        // from left to right, and with 5 % of room above and below: 348 - 314 x 0.05 / 1.1
        const std::string svg = svg_plot({.curves = {{"", {0, 10}, {0, 1}}}});
        CHECK(svg.find("M78.0 333.7L626.0 48.3") != std::string::npos);
    }
}

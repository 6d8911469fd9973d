// Every run writes report.html: what it holds, that nothing is fetched, and that what is not of
// this run is said to be so.

#include "engine/io/whole_file.hpp"
#include "tests/engine/io/html_text.hpp"
#include "tests/scenarios/faults/process.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

using namespace bris;
using testing::count, testing::fetched_by, testing::is_balanced, testing::without_pictures;

namespace {

namespace fs = std::filesystem;

/// The report of a small run into `out`.
std::string report_of(const fs::path& out, std::vector<std::string> more = {}) {
    std::vector<std::string> words{"settle",    "--spheres", "20",    "--duration", "0.001",
                                   "--threads", "1",         "--out", out.string(), "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_process(words);
    CAPTURE(outcome.err);
    REQUIRE(outcome.code == 0);
    return read_whole(out / "report.html");
}

void check_contains(const std::string& html, const std::vector<std::string>& texts) {
    const std::string shown = without_pictures(html);
    for (const std::string& text : texts)
        CHECK_MESSAGE(shown.find(text) != std::string::npos, text, " in ", shown);
}

} // namespace

TEST_SUITE("scenarios/report_page") {
    TEST_CASE("a page tells question, answer, pictures, changed settings, command and files") {
        const TemporaryDirectory folder;
        const fs::path out = folder / "a <b> & 'c'";
        const std::string html = report_of(out, {"--seed", "7"});
        CHECK(is_balanced(without_pictures(html)));
        CHECK(fetched_by(html).empty());
        check_contains(
            html,
            {"<h1>BRIS: settle</h1>", "<p>Spheres settle in a box under gravity.</p>",
             "<td>coordination</td><td>", "How far to trust it", "neither a band nor limits",
             "<td>--spheres</td><td>20</td><td>2000</td><td>Number of spheres.</td>",
             "<td>--duration</td><td>0.001</td><td>0.5</td><td class=\"long\">Simulated time. "
             "(duration_s)</td>",
             "<pre>bris run settle --spheres 20 --duration 0.001 --threads 1 --out '",
             "a &lt;b&gt; &amp; '\\''c'\\''' --quiet --seed 7</pre>", "<td>seed</td><td>7</td>",
             "<td>bris version</td>", "<td>bris commit</td>", "<td>libraries</td>",
             "<a href=\"./summary.json\">summary.json</a> all numbers and settings, "});
        CHECK(html.find("<td>--radius</td>") == std::string::npos); // has its default
        CHECK(html.find("<b>") == std::string::npos);
        CHECK(count(html, "<img ") == 2);
        for (const char* picture : {"settle.png", "settle_history.png"})
            CHECK(html.find(std::string("<figcaption>") + picture) != std::string::npos);
        CHECK(html.find("before this run") == std::string::npos);
    }

    TEST_CASE("a picture of an earlier run is not shown as one of this run") {
        const TemporaryDirectory folder;
        const fs::path old = folder / "old.png";
        write_whole(old, "not of this run");
        fs::last_write_time(old, fs::file_time_type::clock::now() - std::chrono::hours(1));
        const std::string html = report_of(folder.path());
        CHECK(count(html, "<img ") == 2);
        check_contains(html, {"<a href=\"./old.png\">old.png</a> picture, 15 bytes; from before"});
    }
}

// A person reads what a run prints at its end: at most 25 lines of every program, warnings
// included, which only report_results prints; and every run writes a page.

#include "engine/io/whole_file.hpp"
#include "engine/report.hpp"
#include "tests/engine/io/html_text.hpp"
#include "tests/scenarios/faults/process.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

using namespace bris;

namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

const fs::path sources = fs::path(BRIS_SOURCE);

/// A run of each program that takes seconds. The others need minutes for their smallest scene, and
/// are covered by what the sources print.
std::vector<Words> smallest_runs() {
    const std::string small = (sources / "tests/scenarios/small").string();
    return {{"clumps", "--count", "1", "--cube=false"},
            {"collide", "--balls", "20"},
            {"drum", "--small-spheres", "100", "--large-spheres", "30", "--small-radius", "0.004",
             "--large-radius", "0.008", "--duration", "0.01"},
            {"material_card"},
            {"monitor"},
            {"recordings"},
            {"settle", "--spheres", "20", "--duration", "0.001"},
            {"silo", "--spheres", "100", "--diameter", "0.02", "--duration", "0.02", "--window",
             "0.005,0.02"},
            {"smartrock_net", "--duration", "4000", "--headway", "600"},
            {"stress", "--case", "S1"},
            {"track", "--tracks", "2"},
            {"triaxial", "--config", small + "/specimen.cfg", "--grading", small + "/grading.csv",
             "--confining-pressure", "55e3,110e3"},
            {"verify", "--case", "top"}};
}

std::ptrdiff_t lines_in(const std::string& text) { return std::ranges::count(text, '\n'); }

/// How often a source prints to stdout.
std::size_t prints_in(const std::string& source) {
    std::size_t count = 0;
    for (const char* call : {"fmt::print(", "std::cout", "std::printf", "std::puts", ", stdout"})
        for (auto at = source.find(call); at != std::string::npos; at = source.find(call, at + 1))
            ++count;
    return count;
}

} // namespace

TEST_SUITE("scenarios/printed_lines") {
    TEST_CASE("a run prints at most 25 lines, and says where its results are") {
        const TemporaryDirectory folder;
        for (Words words : smallest_runs()) {
            words.insert(words.end(),
                         {"--out", (folder / words.front()).string(), "--quiet", "--threads", "1"});
            const Outcome outcome = run_process(words);
            CAPTURE(words.front());
            CAPTURE(outcome.out);
            CAPTURE(outcome.err);
            CHECK(outcome.code == 0);
            CHECK(lines_in(outcome.out) > 1);
            CHECK(lines_in(outcome.out) + lines_in(outcome.err) <=
                  static_cast<std::ptrdiff_t>(Report::most_lines));
            const std::string page = read_whole(folder / words.front() / "report.html");
            CHECK(testing::is_balanced(testing::without_pictures(page)));
            CHECK(testing::fetched_by(page).empty());
            CHECK(outcome.out.find("\nResults are in " + (folder / words.front()).string()) !=
                  std::string::npos);
        }
    }

    TEST_CASE("no program prints its results itself") {
        const std::map<std::string, std::size_t> others{
            {"bris.cpp", 5},       // of other programs, and of no run
            {"live_demo.cpp", 1},  // address of the page, before the run
            {"recordings.cpp", 1}, // --new: how columns were guessed
            {"stress.cpp", 1},     // --list
            {"verify.cpp", 1}};    // --list
        std::vector<fs::path> files{sources / "tests/stress.cpp", sources / "tests/verify.cpp"};
        for (const auto& entry : fs::recursive_directory_iterator(sources / "scenarios"))
            if (entry.path().extension() == ".cpp" || entry.path().extension() == ".hpp")
                files.push_back(entry.path());
        for (const fs::path& file : files) {
            const auto known = others.find(file.filename().string());
            CAPTURE(file.string());
            CHECK(prints_in(read_whole(file)) == (known == others.end() ? 0 : known->second));
        }
    }
}

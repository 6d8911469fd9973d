// Runs the example of scenarios/README.md as a user would, and compares the listing there with the
// file that is compiled.

#include "engine/io/csv.hpp"
#include "engine/io/whole_file.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <sys/wait.h>

using namespace bris;

namespace {

int exit_code_of_example(const std::filesystem::path& out, const std::string& options) {
    const int status =
        std::system(fmt::format("{}/example_scenario --quiet --out '{}' {} > /dev/null 2>&1",
                                BRIS_BINARIES, out.string(), options)
                        .c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// The text of the value of a key in summary.json, where each key has a line of its own.
std::string value_in(const std::filesystem::path& out, const std::string& key) {
    const std::string text = read_whole(out / "summary.json");
    const std::string begin = fmt::format("\n  \"{}\": ", key);
    const auto at = text.find(begin);
    if (at == std::string::npos) return {};
    const auto first = at + begin.size();
    return text.substr(first, text.find_first_of(",\n", first) - first);
}

} // namespace

TEST_SUITE("scenarios/example_scenario") {
    TEST_CASE("the example of the guide finds the rebound height e^2 h") {
        const TemporaryDirectory out;
        REQUIRE(exit_code_of_example(out.path(), "--height 0.2 --restitution 0.6 --duration 0.4") ==
                0);
        // the apex lies within half a sample of a sample: g (0.5 ms)^2 / 2 = 1.2e-6 m; gravity acts
        // during the contact too, which takes g / (omega v) = 5e-4 of the speed at the most
        const double exact = 0.6 * 0.6 * 0.2;
        const double height = std::stod(value_in(out.path(), "rebound_height_m"));
        CHECK(std::abs(height / exact - 1) < 1e-3);
        CHECK(std::stod(value_in(out.path(), "rebound_height_error")) ==
              doctest::Approx(height / exact - 1).epsilon(1e-6));
        const CsvTable motion = read_csv(out / "bounce.csv");
        CHECK(motion.rows.size() == 400); // a sample every millisecond
        CHECK(std::filesystem::exists(out / "bounce.png"));
    }

    TEST_CASE("the example of the guide refuses a run that is too short, and continues a run to "
              "the same bits") {
        const TemporaryDirectory whole, parts;
        CHECK(exit_code_of_example(whole.path(), "--duration 0.2") == 2);
        CHECK(exit_code_of_example(whole.path(), "--duration 0.4") == 0);
        CHECK(exit_code_of_example(parts.path(), "--duration 0.3") == 0);
        CHECK(exit_code_of_example(parts.path(),
                                   "--duration 0.4 --resume " + parts.path().string()) == 0);
        CHECK(value_in(parts.path(), "fingerprint") == value_in(whole.path(), "fingerprint"));
        CHECK(read_whole(parts / "bounce.csv") == read_whole(whole / "bounce.csv"));
    }

    TEST_CASE("the guide shows the example as it is compiled") {
        const std::filesystem::path root = BRIS_SOURCE;
        const std::string example = read_whole(root / "tests/scenarios/example_scenario.cpp");
        const std::string guide = read_whole(root / "scenarios/README.md");
        CHECK(example.size() > 1000);
        CHECK(guide.find("```cpp\n" + example + "```\n") != std::string::npos);
    }
}

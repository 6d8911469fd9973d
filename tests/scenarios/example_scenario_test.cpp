// Runs the example of scenarios/README.md as a user would, and compares the listing there with the
// file that is compiled.

#include "engine/io/csv.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/math.hpp"
#include "tests/about.hpp"
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

/// Height (m) of the first rebound of the example's sphere after a fall from `height` (m): the
/// exact solution of the contact, a damped linear spring on which gravity acts too.
double exact_rebound(double height, double restitution) {
    constexpr double g = 9.81, stiffness = 1e6, mass = 2600 * 4e-6 / 3 * pi; // density, radius 1 cm
    const double logarithm = std::log(restitution),
                 ratio = -logarithm / std::sqrt(pi * pi + logarithm * logarithm);
    const double undamped = std::sqrt(stiffness / mass), decay = ratio * undamped,
                 frequency = std::sqrt(1 - ratio * ratio) * undamped;
    // height above the plane: exp(-decay t) (a cos(frequency t) + b sin(frequency t)) - a
    const double a = g / (undamped * undamped),
                 b = (decay * a - std::sqrt(2 * g * height)) / frequency;
    const auto oscillation = [&](double t, double in_phase, double out_of_phase) {
        return std::exp(-decay * t) *
               (in_phase * std::cos(frequency * t) + out_of_phase * std::sin(frequency * t));
    };
    double early = 0.5 * pi / frequency, late = 1.5 * pi / frequency;
    for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (early + late);
        (oscillation(middle, a, b) < a ? early : late) = middle;
    }
    const double speed = oscillation(early, frequency * b - decay * a, -frequency * a - decay * b);
    return speed * speed / (2 * g);
}

} // namespace

TEST_SUITE("scenarios/example_scenario") {
    TEST_CASE("the example of the guide finds the height of the first rebound") {
        const TemporaryDirectory out;
        REQUIRE(exit_code_of_example(out.path(), "--height 0.2 --restitution 0.6 --duration 0.4") ==
                0);
        const double height = std::stod(value_in(out.path(), "rebound_height_m")),
                     exact = exact_rebound(0.2, 0.6), without_weight = 0.6 * 0.6 * 0.2;
        // second order in the step: (step / sqrt(m/k))^2 = 3.7e-4; a sample lies within 0.5 ms of
        // the highest point, at most g (0.5 ms)^2 / 2 = 1.7e-5 of the height below it
        CHECK(height == about(exact).epsilon(4e-4));
        // the weight during the contact, of the order of g / (v sqrt(k/m)) = 5e-4 of the speed
        CHECK(height == about(without_weight).epsilon(1.5e-3));
        CHECK(std::stod(value_in(out.path(), "rebound_height_error")) ==
              about(height / without_weight - 1).epsilon(1e-9));
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

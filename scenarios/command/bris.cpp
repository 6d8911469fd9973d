// One command for all scenarios: it lists and runs them, opens what they wrote, and says what a
// machine lacks.
#include "engine/child_program.hpp"
#include "engine/errors.hpp"
#include "engine/exit_codes.hpp"
#include "engine/scenario.hpp"
#include "engine/version.hpp"
#include "scenarios/command/doctor.hpp"
#include "scenarios/command/programs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

using namespace bris;
namespace fs = std::filesystem;
using Words = std::vector<std::string>;

std::string help() {
    std::string text = "bris list                      the scenarios\n"
                       "bris run NAME [--options]      runs one; --help lists its options\n"
                       "bris open RESULTS              opens the report of a folder of results\n"
                       "bris doctor                    says what this machine and build lack\n"
                       "bris --version\n\nExit codes, also of the scenarios:\n";
    for (const auto& [code, meaning] : exit_codes)
        text += fmt::format("  {:<4} {}\n", static_cast<int>(code), meaning);
    return text;
}

void list() {
    const Words names = scenario_names();
    const auto longest = std::ranges::max(names, {}, &std::string::size).size();
    for (const std::string& name : names) {
        const fs::path program = program_of(name);
        fmt::print("{:<{}}  {}\n", name, longest,
                   program.empty() ? "(not built: scenarios/build " + name + ")"
                                   : description_of(program));
    }
}

/// What to look at in a folder of results: its report, or the folder if it has pictures only.
fs::path page_of(const std::string& results) {
    std::error_code error;
    if (!fs::exists(results, error))
        throw OutputError(fmt::format("open: cannot read '{}'", results));
    if (!fs::is_directory(results, error)) return results;
    if (const fs::path page = fs::path(results) / "report.html"; fs::exists(page, error))
        return page;
    for (const auto& entry : fs::directory_iterator(results, error))
        if (entry.path().extension() == ".png") return results;
    throw InputError(fmt::format(
        "open: expected a folder with report.html or pictures, found none in '{}'", results));
}

/// The program that shows a page; empty: there is none, or no screen.
std::string browser() {
    const auto variable = [](const char* name) {
        const char* const text = std::getenv(name);
        return std::string(text != nullptr ? text : "");
    };
    if (const std::string given = variable("BROWSER"); !given.empty())
        return given.substr(0, given.find(':'));
    const bool has_screen = !variable("DISPLAY").empty() || !variable("WAYLAND_DISPLAY").empty();
    return has_screen ? on_path("xdg-open").string() : "";
}

void open_results(const std::string& results) {
    const std::string page = fs::absolute(page_of(results)).lexically_normal().string();
    fmt::print("{}\n", page);
    (void)std::fflush(stdout);
    const std::string program = browser();
    if (program.empty()) return;
    if (const int code = ChildProgram({program, page}, {.is_silent = true}).wait(); code != 0)
        throw OutputError(fmt::format("open: '{}' ended with {}", program, code));
}

void do_as_told(const Words& words) {
    const std::string command = words.empty() ? "--help" : words.front();
    const auto expect = [&](std::size_t count, const char* what) {
        require(words.size() == count + 1,
                fmt::format("{}: expected {}, found {} words", command, what, words.size() - 1));
    };
    if (command == "--help" || command == "-h")
        fmt::print("{}", help());
    else if (command == "--version")
        fmt::print("{}", version_text("bris"));
    else if (command == "list")
        expect(0, "nothing else"), list();
    else if (command == "doctor")
        expect(0, "nothing else"), fmt::print("{}", examine());
    else if (command == "open")
        expect(1, "a folder of results"), open_results(words[1]);
    else
        throw InputError(fmt::format("expected list, run, open or doctor, found \"{}\"", command));
}

} // namespace

int main(int argc, char** argv) {
    const Words words(argv + std::min(argc, 1), argv + argc);
    if (words.empty() || words.front() != "run")
        return detail::exit_code_of("bris", [&] { do_as_told(words); });
    try { // before anything starts that the scenario, which takes this process over, starts itself
        require(words.size() > 1, "run: expected the name of a scenario, found nothing");
        become(words[1], {words.begin() + 2, words.end()});
    } catch (...) {
        return detail::exit_code_of("bris", [&] { throw; });
    }
}

// The command bris: what it lists, starts, opens and finds missing, in a build folder and
// installed.

#include "engine/io/whole_file.hpp"
#include "tests/scenarios/faults/process.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

using namespace bris;

namespace {

namespace fs = std::filesystem;

/// The environment of a process, in which some variables are others; empty: absent.
std::function<bool()> with(const std::vector<std::pair<std::string, std::string>>& variables) {
    return [variables] {
        for (const auto& [name, value] : variables)
            value.empty() ? unsetenv(name.c_str()) : setenv(name.c_str(), value.c_str(), 1);
        return true;
    };
}

const auto without_screen = with({{"BROWSER", ""}, {"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}});

void check_refusal(const std::vector<std::string>& words, int code, const std::string& what) {
    const Outcome outcome = run_process(words, without_screen);
    CAPTURE(words);
    CAPTURE(outcome.err);
    CHECK(outcome.code == code);
    CHECK(is_one_line_of(outcome.err, "bris"));
    CHECK(outcome.err.find(what) != std::string::npos);
    CHECK(outcome.out.empty());
}

/// A program that notes with which words it was started, and its exit code.
fs::path noting_program(const fs::path& folder, int code) {
    const fs::path program = folder / "browser";
    write_whole(program, "#!/bin/sh\necho \"$@\" > '" + (folder / "noted").string() + "'\nexit " +
                             std::to_string(code) + "\n");
    fs::permissions(program, fs::perms::owner_all);
    return program;
}

} // namespace

TEST_SUITE("scenarios/command/bris") {
    TEST_CASE("every scenario is listed with what it does, and no other program") {
        const Outcome outcome = run_process({"bris", "list"});
        CHECK(outcome.code == 0);
        std::vector<std::string> expected{"stress", "verify"}; // these stand in tests/
        for (const auto& entry : fs::directory_iterator(fs::path(BRIS_SOURCE) / "scenarios"))
            if (entry.path().extension() == ".cpp") expected.push_back(entry.path().stem());
        std::ranges::sort(expected);
        std::vector<std::string> found;
        std::istringstream lines(outcome.out);
        for (std::string line; std::getline(lines, line);) {
            found.push_back(line.substr(0, line.find(' ')));
            CHECK_MESSAGE(line.ends_with('.'), line);
        }
        CHECK(found == expected);
        CHECK(outcome.out.find("  Spheres settle in a box under gravity.\n") != std::string::npos);
    }

    TEST_CASE("a scenario that it runs is the scenario: output, messages and exit code") {
        CHECK(run_process({"bris", "run", "settle", "--version"}).out ==
              run_process({"settle", "--version"}).out);
        const Outcome refused = run_process({"bris", "run", "settle", "--spheres", "0"});
        CHECK(refused.code == 2);
        CHECK(is_one_line_of(refused.err, "settle"));
    }

    TEST_CASE("a command that it does not know is refused, and one without words gives help") {
        const Outcome help = run_process({"bris"});
        CHECK(help.code == 0);
        for (const char* command : {"bris list", "bris run NAME", "bris open", "bris doctor"})
            CHECK(help.out.find(command) != std::string::npos);
        CHECK(run_process({"bris", "--help"}).out == help.out);
        CHECK(run_process({"bris", "--version"}).out.starts_with("bris of BRIS "));
        check_refusal({"bris", "lisp"}, 2, "expected list, run, open or doctor, found \"lisp\"");
        check_refusal({"bris", "list", "x"}, 2, "expected nothing else");
        check_refusal({"bris", "run"}, 2, "expected the name of a scenario");
        check_refusal({"bris", "run", "bris"}, 2, "settle, ");
        check_refusal({"bris", "run", "../bin/settle"}, 2, "found \"../bin/settle\"");
        check_refusal({"bris", "open"}, 2, "expected a folder of results");
    }

    TEST_CASE(
        "where it is installed it finds the scenarios in lib/bris, or says that there are none") {
        const TemporaryDirectory prefix;
        fs::create_directories(prefix / "bin");
        fs::copy(fs::path(BRIS_BINARIES) / "bris", prefix / "bin/bris");
        const std::string bris = fs::relative(prefix / "bin/bris", BRIS_BINARIES);
        check_refusal({bris, "run", "settle"}, 4,
                      "settle has not been built: scenarios/build settle");
        CHECK(run_process({bris, "list"}).out.find("settle            (not built: ") !=
              std::string::npos);
        for (const char* folder : {"lib/bris", "libexec/bris"}) {
            fs::create_directories(prefix / folder);
            fs::create_symlink(fs::path(BRIS_BINARIES) / "settle", prefix / folder / "settle");
            CHECK(run_process({bris, "run", "settle", "--version"}).out.starts_with("settle of "));
            fs::remove_all(prefix / folder);
        }
    }

    TEST_CASE("results are opened by the browser, and their path is printed") {
        const TemporaryDirectory folder;
        const auto in = [&](const char* name) { return (folder / name).string(); };
        fs::create_directories(in("page"));
        write_whole(in("page/report.html"), "<p>");
        write_whole(in("pictures/a.png"), "");
        fs::create_directories(in("empty"));
        const fs::path browser = noting_program(folder.path(), 0);
        for (const auto& [results, opened] : {std::pair{"page", "page/report.html"},
                                              {"page/report.html", "page/report.html"},
                                              {"pictures", "pictures"}}) {
            const std::string expected = in(opened) + "\n";
            const Outcome alone = run_process({"bris", "open", in(results)}, without_screen);
            CHECK(alone.code == 0);
            CHECK(alone.out == expected);
            CHECK_FALSE(fs::exists(in("noted")));
            const Outcome shown =
                run_process({"bris", "open", in(results)}, with({{"BROWSER", browser}}));
            CHECK(shown.code == 0);
            CHECK(shown.out == expected);
            CHECK(read_whole(in("noted")) == expected);
            fs::remove(in("noted"));
        }
        check_refusal({"bris", "open", in("empty")}, 2, "report.html or pictures");
        check_refusal({"bris", "open", in("absent")}, 4, "cannot read");
        noting_program(folder.path(), 1);
        CHECK(run_process({"bris", "open", in("page")}, with({{"BROWSER", browser}})).code == 4);
    }

    TEST_CASE("the doctor names what is missing and what that costs") {
        const Outcome outcome = run_process({"bris", "doctor"}, with({{"PATH", "/nowhere"}}));
        CHECK(outcome.code == 0);
        for (const char* line : {"pictures       gnuplot is missing: runs draw no pictures",
                                 "broker         mosquitto is missing: live_demo cannot start",
                                 "to build       c++, cmake, ninja missing: ", "Python         ",
                                 "scenarios      all\n", " cores", " GiB", "libraries      oneTBB"})
            CHECK_MESSAGE(outcome.out.find(line) != std::string::npos, line, outcome.out);
        const Outcome here = run_process({"bris", "doctor"});
        CHECK(std::ranges::count(here.out, '\n') >= 14);
        CHECK(here.out.find("to build       c++, cmake, ninja\n") != std::string::npos);
        CHECK(here.out.find("missing") < here.out.size());
    }
}

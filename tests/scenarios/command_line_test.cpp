// Starts every scenario with flags that it must answer or refuse: the right exit code, one line on
// stderr, nothing run and nothing written.

#include "engine/ensemble.hpp"
#include "engine/io/whole_file.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fcntl.h>
#include <filesystem>
#include <limits>
#include <regex>
#include <set>
#include <spawn.h>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

using namespace bris;

namespace {

namespace fs = std::filesystem;

struct Command {
    std::string scenario;
    std::vector<std::string> flags;
};

struct Outcome {
    int code = -1; ///< -1: ended by a signal, or not started
    std::string out, err;
    bool wrote = false; ///< something in its working directory, where its results would be too
};

/// A process of its own in an empty directory.
Outcome outcome_of(const Command& command) {
    const TemporaryDirectory outside, inside;
    const std::string out = outside / "out", err = outside / "err";
    std::vector<std::string> words{fmt::format("{}/{}", BRIS_BINARIES, command.scenario)};
    words.insert(words.end(), command.flags.begin(), command.flags.end());
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);

    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT,
                                     0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT,
                                     0600);
    posix_spawn_file_actions_addchdir_np(&actions, inside.path().c_str());
    pid_t process = 0;
    int status = 0;
    Outcome outcome;
    if (posix_spawn(&process, pointers[0], &actions, nullptr, pointers.data(), environ) == 0 &&
        waitpid(process, &status, 0) == process) {
        if (WIFEXITED(status)) outcome.code = WEXITSTATUS(status);
        outcome.out = read_whole(out);
        outcome.err = read_whole(err);
    }
    posix_spawn_file_actions_destroy(&actions);
    outcome.wrote = !fs::is_empty(inside.path());
    return outcome;
}

/// Several at once; in the order of the commands.
std::vector<Outcome> outcomes_of(const std::vector<Command>& commands) {
    std::vector<Outcome> outcomes(commands.size());
    run_ensemble(commands.size(), std::max(1u, std::thread::hardware_concurrency()),
                 [&](std::size_t k) { outcomes[k] = outcome_of(commands[k]); });
    return outcomes;
}

std::vector<std::string> scenarios() {
    std::vector<std::string> names{"stress", "verify"}; // these stand in tests/
    for (const auto& entry : fs::directory_iterator(fs::path(BRIS_SOURCE) / "scenarios"))
        if (entry.path().extension() == ".cpp") names.push_back(entry.path().stem().string());
    std::ranges::sort(names);
    return names;
}

std::vector<Outcome> outcomes_of_all(const std::vector<std::string>& flags) {
    std::vector<Command> commands;
    for (const std::string& name : scenarios()) commands.push_back({name, flags});
    return outcomes_of(commands);
}

/// One line, which begins with the name of the scenario.
bool is_complaint(const Outcome& outcome, const std::string& scenario) {
    return outcome.err.starts_with(scenario + ": ") && outcome.err.ends_with('\n') &&
           std::ranges::count(outcome.err, '\n') == 1;
}

/// Whether a command was refused as it should be; `what` is to be named.
void check_refusal(const Command& command, const Outcome& outcome, int code,
                   const std::string& what) {
    CAPTURE(command.scenario);
    CAPTURE(command.flags);
    CAPTURE(outcome.err);
    CHECK(outcome.code == code);
    CHECK(is_complaint(outcome, command.scenario));
    CHECK(outcome.err.find(what) != std::string::npos);
    CHECK(outcome.out.empty());
    CHECK_FALSE(outcome.wrote);
}

/// A flag that takes a number, or several, as --help describes it.
struct NumericOption {
    std::string flag, text = {};
    bool is_integer = false;
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool low_accepted = true, high_accepted = true;
};

/// Range as it stands in front of the default: "From 0 to 1.", "Above 0 and at most 3.".
void read_range(const std::string& text, NumericOption& option) {
    static const std::regex both("From (\\S+) to (\\S+)\\. Default: "),
        lower("(Above|At least) (\\S+)( and (below|at most) (\\S+))?\\. Default: "),
        upper("(Below|At most) (\\S+)\\. Default: ");
    std::smatch found;
    if (std::regex_search(text, found, both)) {
        option.low = std::stod(found[1]);
        option.high = std::stod(found[2]);
    } else if (std::regex_search(text, found, lower)) {
        option.low = std::stod(found[2]);
        option.low_accepted = found[1] == "At least";
        if (found[3].matched) option.high = std::stod(found[5]);
        if (found[3].matched) option.high_accepted = found[4] == "at most";
    } else if (std::regex_search(text, found, upper)) {
        option.high = std::stod(found[2]);
        option.high_accepted = found[1] == "At most";
    }
}

std::vector<NumericOption> numeric_options(const std::string& help) {
    static const std::regex heading("  (--[a-z0-9-]+) <(.+)>");
    std::vector<NumericOption> options;
    std::istringstream lines(help);
    std::string text; // of the option read last
    bool is_numeric = false;
    const auto finish = [&] {
        if (is_numeric) {
            options.back().text = text;
            read_range(text, options.back());
        }
        text.clear();
        is_numeric = false;
    };
    for (std::string line; std::getline(lines, line);) {
        std::smatch found;
        if (line.starts_with("      ")) {
            text += line.substr(5); // with the space before its first word
            continue;
        }
        finish();
        if (!std::regex_match(line, found, heading)) continue;
        const std::string kind = found[2];
        is_numeric = kind != "text" && kind != "name" && kind != "path";
        if (is_numeric) options.push_back({.flag = found[1], .is_integer = kind == "integer"});
    }
    finish();
    return options;
}

/// A number beyond an end of the range, of two ends the `upper` one or the lower one; -1 where it
/// has none.
std::string outside(const NumericOption& option, bool upper) {
    double number = -1;
    if (std::isfinite(option.high) && (upper || !std::isfinite(option.low)))
        number = option.high + (option.high_accepted ? std::max(1.0, std::abs(option.high)) : 0);
    else if (std::isfinite(option.low))
        number = option.low - (option.low_accepted ? std::max(1.0, std::abs(option.low)) : 0);
    return option.is_integer ? fmt::format("{:.0f}", number) : fmt::format("{}", number);
}

/// What nobody can have meant, one of four values in turn, for each option of the first scenario
/// that has it: each process takes its time, and the others declare it in the same place.
std::vector<Command> absurd_commands(const std::vector<std::string>& names,
                                     const std::vector<std::vector<NumericOption>>& options) {
    std::vector<Command> commands;
    std::set<std::string> seen;
    for (std::size_t k = 0; k < names.size(); ++k)
        for (const NumericOption& option : options[k]) {
            if (!seen.insert(option.flag + option.text).second) continue;
            const std::size_t turn = commands.size();
            const std::array values{std::string("nan"), std::string("banana"), std::string("1e999"),
                                    outside(option, turn / 4 % 2 == 0)};
            commands.push_back({names[k], {option.flag, values[turn % values.size()]}});
        }
    return commands;
}

} // namespace

TEST_SUITE("scenarios/command_line") {
    TEST_CASE("every scenario answers --help and --version and does nothing else") {
        const auto names = scenarios();
        REQUIRE(names.size() > 10);
        const auto help = outcomes_of_all({"--help"}), version = outcomes_of_all({"--version"});
        for (std::size_t k = 0; k < names.size(); ++k) {
            CAPTURE(names[k]);
            for (const Outcome& outcome : {help[k], version[k]}) {
                CHECK(outcome.code == 0);
                CHECK(outcome.err.empty());
                CHECK_FALSE(outcome.wrote);
            }
            CHECK(help[k].out.find("\n  --threads <integer>\n") != std::string::npos);
            std::istringstream lines(help[k].out);
            for (std::string line; std::getline(lines, line);)
                CHECK_MESSAGE(line.size() <= 100, line);
            CHECK(version[k].out.starts_with(names[k] + " of BRIS "));
            for (const char* line : {"commit", "compiler", "instruction set", "libraries"})
                CHECK(version[k].out.find(fmt::format("\n{}", line)) != std::string::npos);
        }
    }

    TEST_CASE("--explain prints the systems of a step, or says why there are none") {
        const auto names = scenarios();
        const auto outcomes = outcomes_of_all({"--explain"});
        for (std::size_t k = 0; k < names.size(); ++k) {
            const Outcome& outcome = outcomes[k];
            if (outcome.code != 0) {
                check_refusal({names[k], {"--explain"}}, outcome, 2, "--explain");
                continue;
            }
            CAPTURE(names[k]);
            CHECK_FALSE(outcome.out.empty());
            CHECK(outcome.err.empty());
            CHECK_FALSE(outcome.wrote);
        }
    }

    TEST_CASE("--explain refuses what the run refuses, in the same words") {
        const TemporaryDirectory folder;
        const auto written = [&](const char* name, const std::string& text) {
            write_whole(folder / name, text);
            return (folder / name).string();
        };
        const std::string garbage = written("garbage.csv", "no,table\nat all\n"),
                          wheel = written("wheel.csv", "position_m,axle_load_kN\n0,221000\n"),
                          fines =
                              written("fines.csv",
                                      "sieve_mm,lower_percent,upper_percent\n63,100,100\n50,88,88\n"
                                      "40,55,55\n22.4,20,20\n9.5,13,13\n0.425,4,4\n"
                                      "0.075,2,2\n"),
                          nothing = (folder / "nothing").string();
        std::vector<Command> commands{
            {"collide", {"--offset", "1.9", "--model-offset", "1"}},
            {"settle", {"--duration", "1e-12"}},
            {"silo", {"--window", "2,1"}},
            {"silo", {"--bed", garbage}},
            {"drum", {"--reference", garbage}},
            {"impact_bed", {"--duration", "1e-12"}},
            {"triaxial", {"--confining-pressure", "55e3,55e3"}},
            {"triaxial", {"--material", garbage}},
            {"triaxial", {"--material", nothing}},
            {"twin", {"--confining-pressure", "55e3,110e3"}},
            {"twin", {"--model-packing", "1"}},
            {"specimen_library", {"--truths", garbage}},
            {"specimen_library", {"--library", garbage}},
            {"specimen_library", {"--lowest-friction", "0.9", "--highest-friction", "0.8"}},
            {"live_triaxial", {"--stream", nothing}},
            {"live_triaxial", {"--confining-pressure", "110e3"}},
            {"live_triaxial", {"--recordings", nothing}},
            {"smart_triaxial", {"--friction", "0.5"}},
            {"smart_triaxial", {"--recordings", nothing}},
            {"smart_triaxial", {"--library", garbage}},
            {"smart_triaxial", {"--confining-pressure", "77e3"}},
            {"direct_shear", {"--normal-stress", "50e3,50e3"}},
            {"tie_push", {"--vci", "0,0"}},
            {"ballast_box", {"--saturation", "0.5"}},
            {"track_passage", {"--train", wheel}},
            {"track_passage", {"--first-train", wheel}},
            {"forecast", {"--next-train", wheel}},
            {"forecast", {"--recordings", garbage}},
            {"forecast", {"--ensemble", nothing}}};
        for (const char* scenario :
             {"triaxial", "twin", "specimen_library", "live_triaxial", "smart_triaxial",
              "direct_shear", "tie_push", "ballast_box", "track_passage", "forecast"}) {
            commands.push_back({scenario, {"--grading", garbage}});
            commands.push_back({scenario, {"--clumps", nothing}});
        }
        for (const char* scenario : {"triaxial", "twin", "specimen_library", "direct_shear"})
            commands.push_back({scenario, {"--grading", fines}});
        commands.push_back({"tie_push", {"--grading", fines, "--smallest-rock", "0"}});
        std::vector<Command> explained = commands;
        for (Command& command : explained) command.flags.push_back("--explain");
        const auto by_run = outcomes_of(commands), by_explain = outcomes_of(explained);
        for (std::size_t k = 0; k < commands.size(); ++k) {
            CAPTURE(by_run[k].code);
            check_refusal(explained[k], by_explain[k], by_run[k].code, "");
            CHECK((by_run[k].code == 2 || by_run[k].code == 4));
            CHECK(by_explain[k].err == by_run[k].err);
            CHECK_FALSE(by_run[k].wrote);
        }
    }

    TEST_CASE(
        "a grading and a train in another form are read by every scenario, with one line that "
        "says how") {
        const TemporaryDirectory folder;
        const std::string grading = folder / "sieves.csv", train = folder / "axles.csv";
        write_whole(grading, "Sieve (mm);Retained (%)\n50,8;0,0\n38,1;11,6\n25,4;43,2\n19;33,1\n"
                             "9,5;12,1\n");
        write_whole(train, "axle,spacing_m,load_t\n1,0,22.5\n2,1.8,22.5\n");
        std::vector<Command> commands{{"track_passage", {"--train", train, "--explain"}}};
        for (const char* scenario : {"triaxial", "twin", "specimen_library", "direct_shear"})
            commands.push_back({scenario, {"--grading", grading, "--explain"}});
        const auto outcomes = outcomes_of(commands);
        for (std::size_t k = 0; k < commands.size(); ++k) {
            CAPTURE(commands[k].scenario);
            CAPTURE(outcomes[k].err);
            CHECK(outcomes[k].code == 0);
            CHECK(std::ranges::count(outcomes[k].err, '\n') == 1);
            CHECK(outcomes[k].err.find(": read with ") != std::string::npos);
            CHECK_FALSE(outcomes[k].out.empty());
        }
    }

    TEST_CASE("a checkpoint that is not there is no input to go on from") {
        const std::vector<std::string> flags{"--resume", "nosuch"};
        const auto names = scenarios();
        const auto outcomes = outcomes_of_all(flags);
        for (std::size_t k = 0; k < names.size(); ++k)
            check_refusal({names[k], flags}, outcomes[k], outcomes[k].code == 2 ? 2 : 4,
                          "--resume");
    }

    TEST_CASE("values within the range of their option are refused where they contradict others") {
        for (const Command& command : {Command{"smartrock_net", {"--rock-repeats", "2.5"}},
                                       Command{"smartrock_net", {"--packet-samples", "3.5"}},
                                       Command{"smartrock_net", {"--contact-interval", "0.5"}},
                                       Command{"track", {"--mud-ties", "40", "--ties", "21"}},
                                       Command{"monitor", {"--segment", "77"}}})
            check_refusal(command, outcome_of(command), 2, command.flags.front());
        const Command impact{"verify", {"--restitution", "0.01", "--steps-per-contact", "1.01"}};
        check_refusal(impact, outcome_of(impact), 2, "steps per contact are not enough");
    }

    TEST_CASE("a checkpoint whose name leads to itself is no input to go on from") {
        const TemporaryDirectory folder;
        const std::string loop = folder / "loop.h5";
        fs::create_symlink(loop, loop);
        const Command command{"settle", {"--resume", loop}};
        check_refusal(command, outcome_of(command), 4, "--resume: cannot read");
    }

    TEST_CASE("a flag that no scenario has is refused") {
        const auto names = scenarios();
        const std::vector<std::string> flags{"--xyzzy-of-banana", "1"};
        const auto outcomes = outcomes_of_all(flags);
        for (std::size_t k = 0; k < names.size(); ++k)
            check_refusal({names[k], flags}, outcomes[k], 2, flags.front());
    }

    TEST_CASE("a key that no scenario has is refused with file and line") {
        const TemporaryDirectory directory;
        const std::string file = directory / "a.toml";
        write_whole(file, "# a comment\nseed = 3\nxyzzy_of_banana = 1\n");
        const auto names = scenarios();
        const std::vector<std::string> flags{"--config", file};
        const auto outcomes = outcomes_of_all(flags);
        for (std::size_t k = 0; k < names.size(); ++k)
            check_refusal({names[k], flags}, outcomes[k], 2, file + ":3: ");
    }

    TEST_CASE("every numeric option has a range and refuses what lies outside and what is none") {
        const auto names = scenarios();
        const auto help = outcomes_of_all({"--help"});
        std::vector<std::vector<NumericOption>> options;
        for (std::size_t k = 0; k < names.size(); ++k) {
            options.push_back(numeric_options(help[k].out));
            CHECK(options[k].size() >= 3); // seed, threads, memory
            for (const NumericOption& option : options[k]) {
                CAPTURE(names[k]);
                CAPTURE(option.flag);
                const bool is_seed = option.flag == "--seed" || option.flag == "--model-packing";
                CHECK((is_seed || std::isfinite(option.high)));
                CHECK((option.is_integer || std::isfinite(option.low)));
            }
        }
        const auto commands = absurd_commands(names, options);
        const auto outcomes = outcomes_of(commands);
        for (std::size_t k = 0; k < commands.size(); ++k)
            check_refusal(commands[k], outcomes[k], 2, commands[k].flags.front() + ": expected ");
    }
}

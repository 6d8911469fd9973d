#pragma once

#include "engine/named_value.hpp"
#include "engine/options.hpp"
#include "engine/summary.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace bris {

/// What the common flags set for every scenario.
struct Common {
    std::string scenario;         ///< its name
    std::filesystem::path out;    ///< directory of the results; exists when the scenario runs
    std::filesystem::path resume; ///< checkpoint to go on from; empty: start anew
    unsigned threads = 0;         ///< at least 1 when the scenario runs
    std::uint64_t seed = 1;
    std::uint64_t memory_limit = 0;     ///< bytes; 0: none
    bool explain = false;               ///< print the schedule, simulate nothing
    bool serial = false;                ///< run the list of systems in order: same bits
    bool quiet = false;                 ///< no progress
    std::vector<NamedValue> settings;   ///< every option with its value, for summary and run file
    std::vector<std::string> arguments; ///< as typed
};

/// Prints the results as a table under the scenario's name, and writes summary.json into its
/// directory: scenario, settings, results. Throws OutputError.
void report_results(const Common& common, const Summary& results);

/// What a scenario is called, and which of the common flags it refuses.
struct ScenarioInfo {
    std::string name;
    std::string description; ///< one sentence, for --help
    /// Why there is nothing to resume, as "an impact takes less than a second"; empty: --resume
    /// works.
    std::string cannot_resume = {};
    /// Likewise for --explain.
    std::string cannot_explain = {};
};

namespace detail {
/// Parses the flags of any program. False: --help or --version was asked for and has been answered.
bool parse_or_answer(Options& options, const std::vector<std::string>& arguments,
                     const std::string& name, const std::string& description);
/// Parses the flags of a scenario together with the common ones. False: --help or --version was
/// asked for and has been answered.
bool parse_flags(Options& options, Common& common, int argc, char** argv, const ScenarioInfo& info);
/// Makes the folder of the results and calls `body`. Where the body refuses its input before it
/// has written anything, the folders that were made are removed. Throws OutputError.
void run_in_folder(const std::filesystem::path& folder, const std::function<void()>& body);
/// Runs `body`; errors become one line on stderr and the exit code of their kind.
int exit_code_of(const std::string& name, const std::function<void()>& body);
/// Prints the text of --explain.
void print_explanation(const std::string& text);
} // namespace detail

/// The main function of a scenario: flags into a `Settings` (which describes itself, see Options),
/// then `run(settings, common)`, or with --explain `explain(settings, common)`, which returns the
/// text. Returns the exit code of the process: ExitCode for the house's errors, 3 when memory runs
/// out, 4 for files, 1 for a mistake in the program.
template <class Settings, class Run, class Explain>
int run_scenario(int argc, char** argv, const ScenarioInfo& info, Run&& run, Explain&& explain) {
    return detail::exit_code_of(info.name, [&] {
        Settings settings;
        Options options;
        settings.describe(options);
        Common common;
        if (!detail::parse_flags(options, common, argc, argv, info)) return;
        const Settings& given = settings;
        const Common& flags = common;
        if (common.explain) return detail::print_explanation(explain(given, flags));
        detail::run_in_folder(common.out, [&] { run(given, flags); });
    });
}
/// For a scenario that has nothing to explain (`info.cannot_explain`).
template <class Settings, class Run>
int run_scenario(int argc, char** argv, const ScenarioInfo& info, Run&& run) {
    return run_scenario<Settings>(argc, argv, info, std::forward<Run>(run),
                                  [](const Settings&, const Common&) { return std::string(); });
}

} // namespace bris

#pragma once

#include "engine/assets.hpp"
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

/// Settings that all scenarios have in common.
struct Common {
    std::string scenario;         ///< name of the scenario
    std::string question;         ///< what it does, in one sentence
    std::filesystem::path out;    ///< folder of the results; exists when the scenario runs
    std::filesystem::path assets; ///< folder of the assets by --assets; empty: see assets_folder
    /// Folder of beds that were made before; empty: in the user's cache; none: there is none.
    std::filesystem::path beds = "none";
    std::filesystem::path resume; ///< checkpoint to resume from; empty: start from the beginning
    unsigned threads = 0;         ///< at least 1 when the scenario runs; of each rank
    unsigned ranks = 1;           ///< processes of this run (Ranks)
    std::uint64_t seed = 1;
    std::uint64_t memory_limit = 0;       ///< bytes; 0: no limit
    bool explain = false;                 ///< print the schedule and simulate nothing
    bool quiet = false;                   ///< print no progress
    std::vector<NamedValue> settings;     ///< every option with its value, for summary and run file
    std::vector<std::string> arguments;   ///< as typed
    std::vector<Options::Change> changes; ///< settings that differ from the defaults
    std::filesystem::file_time_type began = std::filesystem::file_time_type::clock::now();
};

/// Writes scenario, settings and results to summary.json in the folder of the results. Throws
/// OutputError.
void write_results(const Common& common, const Summary& results);
/// The same as a Report that shows all results. Throws OutputError.
void report_results(const Common& common, const Summary& results);

/// Name and description of a scenario, and which of the common flags it refuses.
struct ScenarioInfo {
    std::string name;
    std::string description; ///< one sentence for --help
    /// Reason for refusing --resume, such as "an impact takes less than a second"; empty: --resume
    /// is supported.
    std::string cannot_resume = {};
    /// Reason for refusing --explain; empty: --explain is supported.
    std::string cannot_explain = {};
    /// Whether a run may be divided among ranks. All ranks then run the scenario with the same
    /// settings; those but the first write into a folder that is removed, and print nothing.
    bool divides = false;
    /// Whether it makes beds of ballast, which are kept (--beds).
    bool makes_beds = false;
};

namespace detail {
/// Parses the flags of any program. Returns false if --help or --version was requested and has been
/// printed.
bool parse_or_answer(Options& options, const std::vector<std::string>& arguments,
                     const std::string& name, const std::string& description);
/// Parses the flags of a scenario together with the common ones. Returns false if --help or
/// --version was requested and has been printed.
bool parse_flags(Options& options, Common& common, int argc, char** argv, const ScenarioInfo& info);
/// Creates the folder of the results and calls `body`. If `body` ends or throws without having
/// written anything, the folders that were created are removed. Throws OutputError, also if another
/// run that has not ended writes into the same folder.
void run_in_folder(const std::filesystem::path& folder, const std::function<void()>& body);
/// Runs `body` and returns the exit code. An error is printed as one line on stderr and gives the
/// exit code of its kind.
int exit_code_of(const std::string& name, const std::function<void()>& body);
/// Prints the text of --explain.
void print_explanation(const std::string& text);
} // namespace detail

/// The main function of a scenario. Reads the flags into a `Settings` (which describes itself, see
/// Options), calls `check(settings, common)` and then `run(settings, common)`, or with --explain
/// `explain(settings, common)`, which returns the text. `check` refuses what the range of one
/// option does not: options that contradict each other, and files that the run would refuse; it
/// writes nothing. Returns the exit code of the process (see exit_codes).
template <class Settings, class Check, class Run, class Explain>
int run_scenario(int argc, char** argv, const ScenarioInfo& info, Check&& check, Run&& run,
                 Explain&& explain) {
    return detail::exit_code_of(info.name, [&] {
        find_assets(argc, argv);
        Settings settings;
        Options options;
        settings.declare_options(options);
        Common common;
        if (!detail::parse_flags(options, common, argc, argv, info)) return;
        const Settings& given = settings;
        const Common& flags = common;
        check(given, flags);
        if (common.explain) return detail::print_explanation(explain(given, flags));
        detail::run_in_folder(common.out, [&] { run(given, flags); });
    });
}
/// The same for a scenario whose options need no such check.
template <class Settings, class Run, class Explain>
int run_scenario(int argc, char** argv, const ScenarioInfo& info, Run&& run, Explain&& explain) {
    return run_scenario<Settings>(
        argc, argv, info, [](const Settings&, const Common&) {}, std::forward<Run>(run),
        std::forward<Explain>(explain));
}
/// The same for a scenario without --explain (`info.cannot_explain`).
template <class Settings, class Run>
int run_scenario(int argc, char** argv, const ScenarioInfo& info, Run&& run) {
    return run_scenario<Settings>(argc, argv, info, std::forward<Run>(run),
                                  [](const Settings&, const Common&) { return std::string(); });
}

} // namespace bris

#pragma once

#include "engine/named_value.hpp"
#include "engine/options.hpp"
#include "engine/summary.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace bris {

/// What every scenario can be told, whatever it simulates.
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

/// Prints the results as a table under the scenario's name, and writes summary.json into its directory: scenario,
/// settings, results. Throws OutputError.
void report_results(const Common& common, const Summary& results);

namespace detail {
/// Parses the flags of a scenario together with the common ones. False: --help was asked for.
bool parse_flags(Options& options, Common& common, int argc, char** argv, const std::string& name,
                 const std::string& description);
/// Runs `body`; errors become one line on stderr and the exit code of their kind.
int exit_code_of(const std::string& name, const std::function<void()>& body);
} // namespace detail

/// The main function of a scenario: flags into a `Settings` (which describes itself, see Options),
/// then `run(settings, common)`. Returns the exit code of the process: ExitCode for the house's
/// errors, 3 when memory runs out, 4 for files, 1 for a mistake in the program.
template <class Settings, class Run>
int run_scenario(int argc, char** argv, const std::string& name, const std::string& description,
                 Run&& run) {
    return detail::exit_code_of(name, [&] {
        Settings settings;
        Options options;
        settings.describe(options);
        Common common;
        if (detail::parse_flags(options, common, argc, argv, name, description))
            run(static_cast<const Settings&>(settings), static_cast<const Common&>(common));
    });
}

} // namespace bris

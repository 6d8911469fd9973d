#include "engine/scenario.hpp"

#include "engine/errors.hpp"
#include "engine/exit_codes.hpp"
#include "engine/interrupt.hpp"
#include "engine/memory.hpp"
#include "engine/message.hpp"
#include "engine/not_judged.hpp"
#include "engine/ranks.hpp"
#include "engine/report.hpp"
#include "engine/version.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fcntl.h>
#include <new>
#include <sys/file.h>
#include <system_error>
#include <thread>
#include <unistd.h>

namespace bris {

void write_results(const Common& common, const Summary& results) {
    Summary whole;
    whole.add("scenario", common.scenario);
    whole.add(common.settings);
    whole.add(results.entries());
    whole.write(common.out / "summary.json");
}

void report_results(const Common& common, const Summary& results) {
    Report all;
    all.add(results.entries());
    report_results(common, all);
}

} // namespace bris

namespace bris::detail {

namespace {

constexpr unsigned most_ranks_of_core = 4; // enough to try how a run divides

int report(std::string name, std::string message, ExitCode code) {
    std::replace(message.begin(), message.end(), '\n', ' ');
    const bool first = Ranks::is_first();
    if (!first) name += fmt::format(", rank {}", Ranks::rank());
    const auto print = [&] { say(fmt::format("{}: {}", name, message)); };
    if (first) print();
    if (RanksOfProgram::all_fail()) return static_cast<int>(code);
    // the other ranks do not know, and would wait for this one
    if (!first) print();
    RanksOfProgram::abort(static_cast<int>(code));
}

unsigned cores() { return std::max(1U, std::thread::hardware_concurrency()); }

/// Notes how many ranks this process is one of, or will start.
void count_ranks(Common& common, unsigned wanted, const ScenarioInfo& info) {
    const unsigned started = Ranks::size();
    require(wanted <= 1 || wanted == started || started == 1,
            fmt::format("--ranks: expected {} as started, found {}", started, wanted));
    common.ranks = std::max(wanted, started);
    require(common.ranks == 1 || info.divides,
            fmt::format("--ranks: {} runs on one rank only", info.name));
    if (started > 1 || wanted <= cores()) return; // who called mpirun or srun has chosen
    require(wanted <= most_ranks_of_core * cores(),
            fmt::format("--ranks: expected at most {}, {} on each of the {} cores of this machine, "
                        "found {}",
                        most_ranks_of_core * cores(), most_ranks_of_core, cores(), wanted));
    say(fmt::format("{}: warning: --ranks: {} ranks take turns on {} cores", info.name, wanted,
                    cores()));
}

/// Starts the other ranks, or prepares this process to compute as one of them.
void join_ranks(Common& common) {
    if (common.ranks == 1) return;
    if (Ranks::size() == 1) std::exit(start_ranks(common.ranks, common.arguments));
    if (Ranks::is_first()) return;
    common.quiet = true;
    if (std::freopen("/dev/null", "w", stdout) == nullptr)
        throw OutputError("cannot open /dev/null");
}

/// Where a standard stream is closed, the next file that is opened would take its place, and what
/// is printed would go into that file. A stream that can be neither written nor read does so
/// instead.
void occupy_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (fcntl(stream, F_GETFD) == -1)
            (void)open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

void refuse_flag(const char* flag, bool given, const std::string& reason) {
    require(!given || reason.empty(),
            fmt::format("{}: not supported by this scenario: {}", flag, reason));
}

/// Reserves a folder of results for this process. The system releases it when the process ends, in
/// whatever way.
class FolderInUse {
public:
    explicit FolderInUse(const std::filesystem::path& folder)
        : handle_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
        // a file system without locks does not prevent a run
        if (handle_ < 0 || flock(handle_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
        close(handle_);
        throw OutputError(
            fmt::format("--out: expected a folder that no other run uses, found '{}', "
                        "into which another run is writing",
                        folder.string()));
    }
    ~FolderInUse() {
        if (handle_ >= 0) close(handle_);
    }
    FolderInUse(const FolderInUse&) = delete;
    FolderInUse& operator=(const FolderInUse&) = delete;

private:
    int handle_;
};

/// The flags that every scenario has.
struct CommonFlags {
    std::filesystem::path config;
    double memory = 0;
    unsigned ranks = 1;

    void declare_options(Options& option, Common& common, const ScenarioInfo& info) {
        option.group("Options of every scenario");
        option("out", common.out, "", "Folder in which the results are written.");
        option("assets", common.assets, "",
               "Folder of clumps, gradings, materials and example recordings. Default: the folder "
               "assets next to the program, or ../share/bris/assets seen from there.");
        if (info.makes_beds) {
            common.beds.clear();
            option(
                "beds", common.beds, "",
                "Folder of the beds of ballast that were made before, so that none is made twice; "
                "the bits are the same. none: no such folder. Default: bris/beds in the user's "
                "cache (XDG_CACHE_HOME or ~/.cache).");
        }
        option("seed", common.seed, "", "Seed of every random draw.");
        option(
            "threads", common.threads, "",
            "Largest number of threads to use. 0: all cores. Some scenarios use only one thread.",
            within(0, 4096));
        option(
            "ranks", ranks, "",
            "Number of processes (ranks of MPI) among which the world is divided. The results are "
            "the same. More than the cores of the machine take turns, with a warning; more than "
            "four for each core are refused.",
            within(1, 4096));
        option("memory", memory, "GiB",
               "Stop when the run, or one of its ranks, needs more memory than this. 0: no limit.",
               within(0, 1 << 20));
        option("config", config, "",
               "Configuration file of lines `name = value` with the names of these options. Flags "
               "on the "
               "command line take precedence.");
        option("resume", common.resume, "",
               "Checkpoint from which the run is resumed, or a folder of results, whose last "
               "checkpoint "
               "is used.");
        option("explain", common.explain, "", "Print the systems of a time step and exit.");
        option("quiet", common.quiet, "", "Do not print progress.");
    }
};

} // namespace

bool parse_or_answer(Options& options, const std::vector<std::string>& arguments,
                     const std::string& name, const std::string& description) {
    switch (options.parse(arguments)) {
    case Options::Request::help:
        fmt::print("{}", options.help(name, description));
        return false;
    case Options::Request::version:
        fmt::print("{}", version_text(name));
        return false;
    case Options::Request::run:
        break;
    }
    return true;
}

bool parse_flags(Options& options, Common& common, int argc, char** argv,
                 const ScenarioInfo& info) {
    common.scenario = info.name;
    common.question = info.description;
    common.out = std::filesystem::path("results") / info.name;
    common.arguments.assign(argv + std::min(argc, 1), argv + argc);
    CommonFlags flags;
    flags.declare_options(options, common, info);
    if (!parse_or_answer(options, common.arguments, info.name, info.description)) return false;
    refuse_flag("--resume", !common.resume.empty(), info.cannot_resume);
    refuse_flag("--explain", common.explain, info.cannot_explain);
    if (std::error_code error;
        !common.resume.empty() && !std::filesystem::exists(common.resume, error))
        throw OutputError(fmt::format("--resume: cannot read '{}'", common.resume.string()));
    require(common.assets.empty() || common.assets == assets_folder(),
            "--assets: expected on the command line, found in a configuration file");
    common.changes = options.changes();
    for (const std::string& warning : options.warnings())
        say(fmt::format("{}: warning: {}", info.name, warning));
    count_ranks(common, flags.ranks, info);
    join_ranks(common);
    if (common.threads == 0) common.threads = std::max(1U, cores() / Ranks::on_this_machine());
    common.memory_limit = static_cast<std::uint64_t>(std::floor(flags.memory * 0x1p30));
    limit_memory(common.memory_limit, common.threads);
    common.settings = options.values();
    return true;
}

void run_in_folder(const std::filesystem::path& folder, const std::function<void()>& body) {
    if (!Ranks::writes()) return body();
    std::error_code error;
    std::vector<std::filesystem::path> made; // innermost first
    for (auto path = folder; !path.empty() && !std::filesystem::exists(path, error);
         path = path.parent_path())
        made.push_back(path);
    std::filesystem::create_directories(folder, error);
    if (error)
        throw OutputError(
            fmt::format("cannot create directory '{}': {}", folder.string(), error.message()));
    const FolderInUse in_use(folder);
    const auto remove_if_empty = [made = std::move(made)] {
        std::error_code ignored;
        for (const auto& path : made) std::filesystem::remove(path, ignored);
    };
    const Cleanup cleanup(remove_if_empty);
    try {
        body();
    } catch (...) {
        remove_if_empty();
        throw;
    }
    remove_if_empty(); // a flag such as --list writes nothing
}

void print_explanation(const std::string& text) {
    fmt::print("{}{}", text, text.ends_with('\n') ? "" : "\n");
}

int exit_code_of(const std::string& name, const std::function<void()>& body) {
    CatchInterrupts catching(name);
    occupy_standard_streams();
    const RanksOfProgram ranks;
    if (!Ranks::is_first()) catching.be_silent();
    try {
        body();
        if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
            throw OutputError("cannot write to the standard output");
        return static_cast<int>(ExitCode::done);
    } catch (const InputError& error) {
        return report(name, error.what(), ExitCode::bad_input);
    } catch (const SimulationError& error) {
        return report(name, error.what(), ExitCode::failed);
    } catch (const OutputError& error) {
        return report(name, error.what(), ExitCode::io_failure);
    } catch (const NotJudged& less) {
        return report(name, less.what(), ExitCode::not_judged);
    } catch (const Interrupted& stop) {
        const std::string words = how_to_continue();
        return report(name, words.empty() ? stop.what() : "interrupted; " + words,
                      ExitCode::interrupted);
    } catch (const std::system_error& error) { // of a file, or of a closed standard output
        return report(name, error.what(), ExitCode::io_failure);
    } catch (const std::bad_alloc&) {
        return report(name, "out of memory", ExitCode::failed);
    } catch (const std::exception& error) {
        return report(name, fmt::format("internal error: {}", error.what()),
                      ExitCode::internal_error);
    } catch (...) {
        return report(name, "internal error of unknown kind", ExitCode::internal_error);
    }
}

} // namespace bris::detail

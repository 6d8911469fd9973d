#include "engine/scenario.hpp"

#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <new>
#include <thread>

namespace bris {

void report_results(const Common& common, const Summary& results) {
    Summary whole;
    whole.add("scenario", common.scenario);
    whole.add(common.settings);
    whole.add(results.entries());
    whole.write(common.out / "summary.json"); // before the terminal: who reads there may have gone
    results.print(common.scenario);
}

} // namespace bris

namespace bris::detail {

namespace {

int report(const std::string& name, std::string message, int code) {
    std::replace(message.begin(), message.end(), '\n', ' ');
    fmt::print(stderr, "{}: {}\n", name, message);
    return code;
}

int report(const std::string& name, const std::string& message, ExitCode code) {
    return report(name, message, static_cast<int>(code));
}

void refuse_flag(const char* flag, bool given, const std::string& reason) {
    require(!given || reason.empty(), fmt::format("{}: not for this scenario: {}", flag, reason));
}

/// The flags that every scenario has.
struct CommonFlags {
    std::filesystem::path config;
    double memory = 0;

    void describe(Options& option, Common& common) {
        option.group("of every scenario");
        option("out", common.out, "", "directory of the results");
        option("seed", common.seed, "", "of every random draw");
        option("threads", common.threads, "", "to run on; 0: all cores", at_most(4096));
        option("memory", memory, "GiB", "stop when more is needed; 0: no limit",
               within(0, 1 << 20));
        option("config", config, "", "file of lines `name = value`; flags overrule it");
        option("resume", common.resume, "", "checkpoint file, or folder of results, to go on from");
        option("explain", common.explain, "", "print the schedule and end");
        option("serial", common.serial, "", "run the systems one after the other: same results");
        option("quiet", common.quiet, "", "no progress");
    }
};

} // namespace

bool parse_flags(Options& options, Common& common, int argc, char** argv,
                 const ScenarioInfo& info) {
    common.scenario = info.name;
    common.out = std::filesystem::path("results") / info.name;
    common.arguments.assign(argv + std::min(argc, 1), argv + argc);
    CommonFlags flags;
    flags.describe(options, common);
    if (!options.parse(common.arguments)) {
        fmt::print("{}", options.help(info.name, info.description));
        return false;
    }
    refuse_flag("--resume", !common.resume.empty(), info.cannot_resume);
    refuse_flag("--explain", common.explain, info.cannot_explain);
    if (!common.resume.empty() && !std::filesystem::exists(common.resume))
        throw OutputError(fmt::format("--resume: cannot read '{}'", common.resume.string()));
    if (common.threads == 0) common.threads = std::max(1u, std::thread::hardware_concurrency());
    common.memory_limit = static_cast<std::uint64_t>(std::floor(flags.memory * 0x1p30));
    limit_memory(common.memory_limit, common.threads);
    common.settings = options.values();
    return true;
}

void make_folder(const Common& common) {
    std::error_code error;
    std::filesystem::create_directories(common.out, error);
    if (error)
        throw OutputError(
            fmt::format("cannot make directory '{}': {}", common.out.string(), error.message()));
}

void print_explanation(const std::string& text) {
    fmt::print("{}{}", text, text.ends_with('\n') ? "" : "\n");
}

int exit_code_of(const std::string& name, const std::function<void()>& body) {
    try {
        catch_interrupts();
        body();
        return static_cast<int>(ExitCode::done);
    } catch (const InputError& error) {
        return report(name, error.what(), ExitCode::bad_input);
    } catch (const SimulationError& error) {
        return report(name, error.what(), ExitCode::stopped_by_guard);
    } catch (const OutputError& error) {
        return report(name, error.what(), ExitCode::io_failure);
    } catch (const Interrupted& stop) {
        return report(name, stop.what(), ExitCode::interrupted);
    } catch (const std::filesystem::filesystem_error& error) {
        return report(name, error.what(), ExitCode::io_failure);
    } catch (const std::bad_alloc&) {
        return report(name, "out of memory", ExitCode::stopped_by_guard);
    } catch (const std::exception& error) {
        return report(name, fmt::format("internal error: {}", error.what()), 1);
    } catch (...) {
        return report(name, "internal error of unknown kind", 1);
    }
}

} // namespace bris::detail

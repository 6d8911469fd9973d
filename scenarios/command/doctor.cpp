#include "scenarios/command/doctor.hpp"

#include "engine/child_program.hpp"
#include "engine/memory.hpp"
#include "engine/ranks.hpp"
#include "engine/version.hpp"
#include "scenarios/command/programs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <thread>
#include <unistd.h>
#include <vector>

namespace bris {

namespace {

struct Finding {
    std::string part, found;
    std::string cost = {}; ///< what is lost; empty: nothing is
};

/// Of a program that others start.
Finding look_for(const std::string& part, const std::string& program, const std::string& cost) {
    const std::string path = on_path(program).string();
    return path.empty() ? Finding{part, program + " is missing", cost} : Finding{part, path};
}

std::string fact(const std::string& key) {
    for (const NamedValue& entry : version_entries())
        if (entry.key == key) return entry.text();
    return {};
}

Finding compilers() {
    std::string missing;
    for (const char* tool : {"c++", "cmake", "ninja"})
        if (on_path(tool).empty())
            missing += fmt::format("{}{}", missing.empty() ? "" : ", ", tool);
    if (missing.empty()) return {"to build", "c++, cmake, ninja"};
    return {"to build", missing + " missing", "what is built runs, but nothing can be built"};
}

Finding scenarios() {
    std::string missing;
    for (const std::string& name : scenario_names())
        if (program_of(name).empty()) missing += (missing.empty() ? "" : " ") + name;
    if (missing.empty()) return {"scenarios", "all"};
    return {"scenarios", "not built: " + missing, "they cannot be run: scenarios/build NAME"};
}

Finding threads() {
    const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
    return {"threads", fmt::format("{} cores", cores),
            cores > 1 ? "" : "a run takes twice as long as on two"};
}

Finding memory() {
    const double size = static_cast<double>(machine_memory()) * 0x1p-30;
    constexpr double enough = 3.5; // GiB that a machine of 4 GB shows
    return {"memory", fmt::format("{:.1f} GiB", size),
            size >= enough ? "" : "a build or a large specimen may run out of it"};
}

std::vector<Finding> ranks() {
    if (!Ranks::available())
        return {{"ranks", "built without MPI", "--ranks is refused; one machine needs none"}};
    return {look_for("ranks", "mpirun", "--ranks is refused; one machine needs none")};
}

std::vector<Finding> broker() {
    std::vector<Finding> findings;
    const bool has_client = fact("libraries").find("mosquitto") != std::string::npos;
    findings.push_back({"broker client", has_client ? "libmosquitto" : "built without libmosquitto",
                        has_client ? "" : "no --broker, so no live test but from files and pipes"});
    findings.push_back(look_for("broker", "mosquitto",
                                "live_demo cannot start; a broker on "
                                "another machine can be used"));
    return findings;
}

Finding python() {
    // the module is built for Debian's, which may not be the first along PATH
    constexpr auto debian = "/usr/bin/python3";
    const std::string program = access(debian, X_OK) == 0 ? debian : on_path("python3").string();
    std::string missing;
    for (const char* module : {"numpy", "h5py"})
        if (program.empty() ||
            ChildProgram({program, "-c", fmt::format("import {}", module)}, {.is_silent = true})
                    .wait() != 0)
            missing += fmt::format(" {}", module);
    const std::string found = program.empty() ? "python3" : program;
    if (missing.empty()) return {"Python", found + " with numpy and h5py"};
    return {"Python", fmt::format("{} without{}", found, missing),
            "no results as arrays (import bris)"};
}

} // namespace

std::string examine() {
    std::vector<Finding> all{{"BRIS", fact("bris_version") + ", commit " + fact("bris_commit")},
                             {"compiled by", fact("compiler")},
                             {"for", fact("instruction_set")},
                             {"libraries", fact("libraries")}};
    const auto add = [&](const std::vector<Finding>& more) {
        all.insert(all.end(), more.begin(), more.end());
    };
    add({scenarios(), compilers(), threads(), memory(),
         look_for("pictures", "gnuplot", "runs draw no pictures; all numbers are written")});
    add(ranks());
    add(broker());
    add({python(), look_for("browser", "xdg-open", "bris open prints the path of a page only")});
    std::string text;
    std::size_t faults = 0;
    for (const Finding& one : all) {
        text += fmt::format("{:<14} {}{}{}\n", one.part, one.found, one.cost.empty() ? "" : ": ",
                            one.cost);
        if (!one.cost.empty()) ++faults;
    }
    return text + (faults == 0 ? "Nothing is missing.\n"
                               : fmt::format("{} thing{} missing.\n", faults,
                                             faults == 1 ? " is" : "s are"));
}

} // namespace bris

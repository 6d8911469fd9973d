#include "engine/memory.hpp"

#include "engine/errors.hpp"
#include "engine/ranks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <malloc.h>
#include <string>
#include <string_view>
#include <sys/resource.h>
#include <unistd.h>

namespace bris {

namespace {

namespace fs = std::filesystem;

double gigabytes(double bytes) { return bytes / 0x1p30; }

/// Bytes; 0 if the system does not say.
std::uint64_t entry_of_status(std::string_view name) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with(name)) return std::stoull(line.substr(name.size())) * 1024;
    return 0;
}

} // namespace

void return_free_memory() { malloc_trim(0); }

std::uint64_t memory_of_groups(const fs::path& root) {
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    std::ifstream groups(root / "proc/self/cgroup"); // number:controllers:/path
    for (std::string line; std::getline(groups, line);) {
        const auto first = line.find(':'), second = line.find(':', first + 1);
        if (second == std::string::npos) continue;
        const std::string controllers = line.substr(first + 1, second - first - 1);
        const bool is_new = controllers.empty(); // version 2 has one hierarchy
        if (!is_new && controllers.find("memory") == std::string::npos) continue;
        const fs::path top = root / (is_new ? "sys/fs/cgroup" : "sys/fs/cgroup/memory");
        const char* const file = is_new ? "memory.max" : "memory.limit_in_bytes";
        for (fs::path group = line.substr(second + 1);; group = group.parent_path()) {
            std::ifstream limit(top / group.relative_path() / file);
            if (std::uint64_t most = 0; limit >> most) least = std::min(least, most); // or "max"
            if (!group.has_relative_path()) break;
        }
    }
    return least;
}

std::uint64_t machine_memory() {
    const std::uint64_t bytes = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
                                static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
    return std::min(bytes, memory_of_groups("/"));
}

// ru_maxrss of getrusage would count the process that started this one
std::uint64_t largest_memory() { return entry_of_status("VmHWM:"); }

double bytes_of_process() {
    constexpr double later = 1.15e8; // lists, threads of libraries, pictures
#ifdef BRIS_SANITIZED                // the shadow memory would count
    return 3.5e7 + later;
#else
    static const auto before = static_cast<double>(entry_of_status("VmData:"));
    return before + later;
#endif
}

void limit_memory(std::uint64_t bytes, unsigned threads) {
    const double least = bytes_of_process() + bytes_of_thread * threads,
                 found = static_cast<double>(bytes);
    if (bytes == 0)
        return; // what the process reserves is noted all the same, before a scene exists
    require(found >= least, fmt::format("--memory: expected 0 (no limit) or at least {:.3g} GiB, "
                                        "which a process with {} threads needs, found {:.3g}",
                                        gigabytes(least) + 0.0005, threads, gigabytes(found)));
#ifndef BRIS_SANITIZED // the shadow memory of a sanitizer would count
    rlimit limit{};
    getrlimit(RLIMIT_DATA, &limit);
    limit.rlim_cur = std::min<rlim_t>(bytes, limit.rlim_max);
    require(setrlimit(RLIMIT_DATA, &limit) == 0,
            fmt::format("--memory: expected a limit that this system accepts, found {:.3g} GiB",
                        gigabytes(static_cast<double>(bytes))));
#endif
}

void require_memory(const std::string& option, double count, double bytes, std::uint64_t limit) {
    const unsigned ranks = Ranks::on_this_machine(); // each of them needs as much
    const std::uint64_t share = machine_memory() / ranks;
    const bool asked = limit > 0 && limit < share;
    const double most = static_cast<double>(asked ? limit : share);
    const std::string of = asked        ? "--memory"
                           : ranks == 1 ? "the memory of this machine"
                                        : fmt::format("the memory of this machine for each of {} "
                                                      "ranks",
                                                      ranks);
    require(bytes <= most,
            fmt::format(
                "--{}: expected a number that fits in {:.3g} GiB ({}), found {:.6g}, which needs "
                "about {:.3g} GiB",
                option, gigabytes(most), of, count, gigabytes(bytes)));
}

} // namespace bris

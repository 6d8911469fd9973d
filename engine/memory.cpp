#include "engine/memory.hpp"

#include "engine/errors.hpp"
#include "engine/ranks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <sys/resource.h>
#include <unistd.h>

namespace bris {

namespace {
double gigabytes(double bytes) { return bytes / 0x1p30; }
} // namespace

std::uint64_t machine_memory() {
    std::uint64_t bytes = static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
                          static_cast<std::uint64_t>(sysconf(_SC_PAGE_SIZE));
    std::ifstream group("/sys/fs/cgroup/memory.max"); // "max" if there is no limit
    if (std::uint64_t most = 0; group >> most) bytes = std::min(bytes, most);
    return bytes;
}

std::uint64_t largest_memory() {
    // ru_maxrss of getrusage would count the process that started this one
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6)) * 1024;
    return 0;
}

void limit_memory(std::uint64_t bytes, unsigned threads) {
    if (bytes == 0) return;
    const double least = bytes_of_process + bytes_of_thread * threads,
                 found = static_cast<double>(bytes);
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

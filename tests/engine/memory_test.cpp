#include "engine/errors.hpp"
#include "engine/memory.hpp"
#include "tests/scenarios/faults/process.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

using namespace bris;

namespace {

std::string refusal(double bytes, std::uint64_t limit) {
    try {
        require_memory("spheres", 5e7, bytes, limit);
        return "";
    } catch (const InputError& error) {
        return error.what();
    }
}

Outcome settle_within(double gibibytes, const std::string& spheres, const std::string& threads) {
    const TemporaryDirectory out;
    return run_process({"settle", "--quiet", "--duration", "0.001", "--spheres", spheres,
                        "--threads", threads, "--memory", fmt::format("{}", gibibytes), "--out",
                        (out / "x").string()});
}

/// The number before " GiB" behind some words; NaN if they are not there.
double gibibytes_after(const std::string& text, const std::string& words) {
    const auto at = text.find(words);
    return at == std::string::npos ? std::nan("") : std::stod(text.substr(at + words.size()));
}

} // namespace

TEST_SUITE("engine/memory") {
    TEST_CASE("a request that fits in memory is accepted, a larger one is rejected with the "
              "estimated size") {
        const auto all = static_cast<double>(machine_memory());
        CHECK(refusal(0.9 * all, 0) == "");
        CHECK(refusal(1.1 * all, 0).find("the memory of this machine") != std::string::npos);
        CHECK(refusal(0x1.8p30, std::uint64_t{1} << 30) ==
              "--spheres: expected a number that fits in 1 GiB (--memory), found 5e+07, which "
              "needs about "
              "1.5 GiB");
        CHECK(refusal(0x0.8p30, std::uint64_t{1} << 30) == "");
    }

    TEST_CASE("the limit of a control group holds for the groups in it, in both versions") {
        const TemporaryDirectory root;
        const auto write = [&](const std::string& file, const std::string& text) {
            std::filesystem::create_directories((root / file).parent_path());
            std::ofstream(root / file) << text;
        };
        const auto limit = [&] { return memory_of_groups(root.path()); };
        constexpr auto none = std::numeric_limits<std::uint64_t>::max();
        CHECK(limit() == none); // a system without groups
        write("proc/self/cgroup", "0::/slurm/job_7/step_0\n");
        write("sys/fs/cgroup/slurm/job_7/step_0/memory.max", "max\n");
        CHECK(limit() == none);
        write("sys/fs/cgroup/slurm/job_7/memory.max", "3000000000\n");
        CHECK(limit() == 3'000'000'000);
        write("sys/fs/cgroup/memory.max", "2000000000\n");
        CHECK(limit() == 2'000'000'000);
        write("proc/self/cgroup", "12:cpu,cpuacct:/a\n4:memory:/a\n0::/\n");
        write("sys/fs/cgroup/memory/a/memory.limit_in_bytes", "1000000000\n");
        CHECK(limit() == 1'000'000'000);
    }

    TEST_CASE("a scenario is rejected if the memory limit is too small for any process or for its "
              "scene, and runs with as much memory as its scene is estimated to need") {
        for (const double limit : {0.001, 0.03, 0.06, 0.1})
            CHECK(settle_within(limit, "10", "1").code == 2);
        for (const std::string threads : {"1", "4"}) {
            CAPTURE(threads);
            const double least =
                gibibytes_after(settle_within(0.01, "10", threads).err, "or at least ");
            REQUIRE(least > 0.1);
            CHECK(settle_within(least - 0.002, "500", threads).code == 2);
            CHECK(settle_within(least + 0.002, "500", threads).code == 0);
        }
        const double needed =
            gibibytes_after(settle_within(0.17, "50000", "1").err, "needs about ");
        REQUIRE(needed > 0.25);
        CHECK(settle_within(needed - 0.001, "50000", "1").code == 2);
        CHECK(settle_within(needed + 0.001, "50000", "1").code == 0);
    }

    TEST_CASE("a limit beyond the memory of the machine is replaced by it") {
        const std::uint64_t all = machine_memory();
        CHECK(refusal(1.1 * static_cast<double>(all), 2 * all).find("the memory of this machine") !=
              std::string::npos);
    }
}

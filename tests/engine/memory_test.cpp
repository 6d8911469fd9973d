#include "engine/errors.hpp"
#include "engine/memory.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cstdlib>
#include <string>
#include <sys/wait.h>

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

/// Exit code of a scenario in a separate process; -1: it was ended by a signal.
int exit_code_of_settle(const std::string& options) {
    const TemporaryDirectory out;
    const int status = std::system((BRIS_BINARIES "/settle --quiet --duration 0.001 " + options +
                                    " --out " + (out / "x").string() + " > /dev/null 2>&1")
                                       .c_str());
    return WIFEXITED(status) && WEXITSTATUS(status) < 128 ? WEXITSTATUS(status) : -1;
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

    TEST_CASE("a scenario is rejected if the memory limit is too small for any process or for its "
              "scene, and runs with as much memory as its scene is estimated to need") {
        for (const char* limit : {"0.001", "0.03", "0.06", "0.1"}) {
            CAPTURE(limit);
            CHECK(exit_code_of_settle(std::string("--spheres 10 --threads 1 --memory ") + limit) ==
                  2);
        }
        CHECK(exit_code_of_settle("--spheres 500 --threads 1 --memory 0.137") == 0);
        CHECK(exit_code_of_settle("--spheres 500 --threads 4 --memory 0.15") == 0);
        CHECK(exit_code_of_settle("--spheres 16000 --threads 1 --memory 0.189") == 2); // 0.190 GiB
        CHECK(exit_code_of_settle("--spheres 16000 --threads 1 --memory 0.191") == 0);
    }

    TEST_CASE("a limit beyond the memory of the machine is replaced by it") {
        const std::uint64_t all = machine_memory();
        CHECK(refusal(1.1 * static_cast<double>(all), 2 * all).find("the memory of this machine") !=
              std::string::npos);
    }
}

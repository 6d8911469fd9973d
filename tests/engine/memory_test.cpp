#include "engine/errors.hpp"
#include "engine/memory.hpp"

#include <doctest/doctest.h>

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

} // namespace

TEST_SUITE("engine/memory") {
    TEST_CASE("what fits is let through, what does not is refused with the estimate") {
        const auto all = static_cast<double>(machine_memory());
        CHECK(refusal(0.9 * all, 0) == "");
        CHECK(refusal(1.1 * all, 0).find("all that this machine has") != std::string::npos);
        CHECK(refusal(0x1.8p30, std::uint64_t{1} << 30) == "--spheres: expected what fits in 1 GiB (--memory), found 5e+07, which take about 1.5 GiB");
        CHECK(refusal(0x0.8p30, std::uint64_t{1} << 30) == "");
    }

    TEST_CASE("a limit beyond the machine is the machine's") {
        const std::uint64_t all = machine_memory();
        CHECK(refusal(1.1 * static_cast<double>(all), 2 * all).find("all that this machine has") != std::string::npos);
    }
}

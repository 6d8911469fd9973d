#include "engine/processor.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

using namespace bris;

namespace {

/// Names of instructions, and what Linux calls them.
const std::map<std::string, std::string> names{{"sse4.2", "sse4_2"},
                                               {"popcnt", "popcnt"},
                                               {"avx", "avx"},
                                               {"avx2", "avx2"},
                                               {"bmi", "bmi1"},
                                               {"bmi2", "bmi2"},
                                               {"fma", "fma"},
                                               {"avx512f", "avx512f"},
                                               {"avx512cd", "avx512cd"},
                                               {"avx512dq", "avx512dq"},
                                               {"avx512bw", "avx512bw"},
                                               {"avx512vl", "avx512vl"},
                                               {"avx512vbmi", "avx512vbmi"},
                                               {"avx512vbmi2", "avx512_vbmi2"},
                                               {"avx512ifma", "avx512ifma"},
                                               {"avx512vnni", "avx512_vnni"},
                                               {"avx512bitalg", "avx512_bitalg"},
                                               {"avx512vpopcntdq", "avx512_vpopcntdq"}};

/// The flags of the first processor, empty where Linux tells none.
std::vector<std::string> flags() {
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);)
        if (line.starts_with("flags")) {
            std::istringstream words(line);
            return {std::istream_iterator<std::string>(words), {}};
        }
    return {};
}

} // namespace

TEST_SUITE("engine/processor") {
    TEST_CASE("instructions are found where the system lists them, and nowhere else") {
        const std::vector<std::string> listed = flags();
        if (listed.empty()) return; // not an x86 processor
        for (const auto& [name, flag] : names) {
            CAPTURE(name);
            CHECK(has_instructions(name.c_str()) ==
                  (std::find(listed.begin(), listed.end(), flag) != listed.end()));
        }
    }

    TEST_CASE("all instructions that this binary needs are known, and here") {
        for (auto name = detail::needed_instructions; *name != nullptr; ++name) {
            CAPTURE(*name);
            CHECK(names.contains(*name));
            CHECK(has_instructions(*name));
        }
    }
}

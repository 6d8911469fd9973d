#include "engine/version.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cctype>

using namespace bris;

namespace {

std::string entry(const std::string& key) {
    for (const NamedValue& e : version_entries())
        if (e.key == key) return std::get<std::string>(e.value);
    return {};
}

/// Hexadecimal, and whether files differ from it; or not known.
bool is_commit(std::string text) {
    if (text == "unknown") return true;
    if (text.ends_with("-dirty")) text.resize(text.size() - 6);
    return text.size() >= 12 &&
           std::ranges::all_of(text, [](unsigned char c) { return std::isxdigit(c) != 0; });
}

} // namespace

TEST_SUITE("engine/version") {
    TEST_CASE("a binary knows what it was made from") {
        CHECK(entry("bris_version").find('.') != std::string::npos);
        CHECK(is_commit(entry("bris_commit")));
        CHECK(entry("compiler") == compiler());
        CHECK(entry("instruction_set") == instruction_set());
        const std::string libraries = entry("libraries");
        for (const char* name : {"oneTBB ", "Eigen ", "HDF5 ", "OpenVDB ", "fmt ", "nanoflann ",
                                 "nlohmann-json ", "Boost "}) {
            const auto at = libraries.find(name);
            CAPTURE(name);
            REQUIRE(at != std::string::npos);
            const auto first = at + std::string(name).size();
            REQUIRE(first < libraries.size());
            CHECK(std::isdigit(static_cast<unsigned char>(libraries[first])) != 0);
        }
    }

    TEST_CASE("--version is of the program and has a line for each of them") {
        const std::string text = version_text("settle");
        CHECK(text.starts_with("settle of BRIS " + entry("bris_version") + "\n"));
        CHECK(std::ranges::count(text, '\n') ==
              static_cast<std::ptrdiff_t>(version_entries().size()));
        for (const NamedValue& e : version_entries())
            CHECK(text.find(std::get<std::string>(e.value)) != std::string::npos);
    }
}

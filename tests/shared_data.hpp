#pragma once

#include <doctest/doctest.h>

#include <filesystem>
#include <string>

namespace bris::testing {

/// A file or folder of data/ in the folder `shared` beside the checkout; where it is not there,
/// empty, and ctest counts the test as skipped (list_tests.cmake). `source`: root of the project.
inline std::filesystem::path shared_data(const std::string& source, const std::string& name) {
    const auto path = std::filesystem::path(source) / ".." / "shared" / "data" / name;
    if (std::filesystem::exists(path)) return path;
    MESSAGE("skipped: no data ", name);
    return {};
}

} // namespace bris::testing

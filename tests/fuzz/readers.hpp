#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// A reader of files from outside.
struct FuzzedReader {
    std::string_view name;
    std::string_view extension; ///< of its files
    /// Valid inputs, made from files of `assets` or in a `folder` for temporary files.
    std::vector<std::string> (*valid)(const std::filesystem::path& assets,
                                      const std::filesystem::path& folder);
    /// Reads a file. Throws InputError or OutputError for a bad one.
    void (*read)(const std::filesystem::path& file);
    bool in_place = false; ///< whether bytes keep their places, as in files with addresses
};

std::span<const FuzzedReader> fuzzed_readers();

} // namespace bris

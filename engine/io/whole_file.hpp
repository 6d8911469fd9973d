#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace bris {

/// Content of a file. Throws OutputError if it cannot be read.
std::string read_whole(const std::filesystem::path& path);

/// Writes `content` beside `path` and renames it over `path`: whoever looks finds the old file or
/// the whole new one, also after a crash. Makes missing directories. Throws OutputError.
void write_whole(const std::filesystem::path& path, std::string_view content);

} // namespace bris

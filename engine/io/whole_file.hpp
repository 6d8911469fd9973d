#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace bris {

/// The content of a file. Throws OutputError if it cannot be read.
std::string read_whole(const std::filesystem::path& path);

/// Writes `content` under a temporary name and renames it to `path`, so that a reader finds either
/// the old file or the complete new one, also after a crash. Creates missing directories. Throws
/// OutputError.
void write_whole(const std::filesystem::path& path, std::string_view content);

} // namespace bris

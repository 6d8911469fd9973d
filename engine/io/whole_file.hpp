#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace bris {

/// Bytes of a file.
struct FileRange {
    std::uint64_t first = 0, bytes = 0;
};

/// Throws OutputError if `path` is there and is something else than a file: a folder, a pipe (whose
/// opening would wait for a writer), a socket or a device. Every reader of a file calls it before
/// it opens one; only LineSource reads pipes.
void require_regular_file(const std::filesystem::path& path);

/// The file that is to be written under this name: `path`, or what it leads to if it is a symbolic
/// link. Throws OutputError if that is there and is something else than a file, which a new file
/// would replace without a word. Every writer of a file calls it before it opens one.
std::filesystem::path file_to_write(const std::filesystem::path& path);

/// Name beside `path` under which a file is written before it is renamed to `path`. It contains the
/// process id, because two runs into one directory must not share the unfinished file.
std::filesystem::path temporary_name(const std::filesystem::path& path);

/// The content of a file. Throws OutputError if it cannot be read.
std::string read_whole(const std::filesystem::path& path);
/// A text without the byte order mark with which spreadsheets begin a file of UTF-8.
std::string_view without_mark(std::string_view text);
/// The content of a text file as UTF-8 (as_utf8). Throws OutputError, InputError for UTF-32.
std::string read_text(const std::filesystem::path& path);

/// Writes `content` under a temporary name and renames it to `path`, so that a reader finds either
/// the old file or the complete new one, also after a crash. Creates missing directories. Only the
/// first rank of a run writes. Throws OutputError.
void write_whole(const std::filesystem::path& path, std::string_view content);

} // namespace bris

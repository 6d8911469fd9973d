#include "engine/io/whole_file.hpp"

#include "engine/errors.hpp"
#include "engine/io/encoding.hpp"
#include "engine/io/unfinished_file.hpp"
#include "engine/ranks.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>
#include <unistd.h>

namespace bris {

namespace {

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

[[noreturn]] void fail(const char* verb, const std::filesystem::path& path, int error) {
    throw OutputError(fmt::format("cannot {} '{}': {}", verb, path.string(), std::strerror(error)));
}

const char* kind_of(std::filesystem::file_type type) {
    using enum std::filesystem::file_type;
    switch (type) {
    case directory:
        return "a folder";
    case fifo:
        return "a pipe";
    case socket:
        return "a socket";
    default:
        return "a device";
    }
}

} // namespace

void require_regular_file(const std::filesystem::path& path) {
    std::error_code error; // a file that is not there is reported by whoever opens it
    const auto type = std::filesystem::status(path, error).type();
    using enum std::filesystem::file_type;
    if (type != regular && type != not_found && type != none && type != unknown)
        throw OutputError(fmt::format("cannot read '{}': expected a file, found {}", path.string(),
                                      kind_of(type)));
}

std::filesystem::path file_to_write(const std::filesystem::path& path) {
    std::error_code error;
    const auto type = std::filesystem::status(path, error).type();
    using enum std::filesystem::file_type;
    if (type == fifo || type == socket || type == character || type == block)
        throw OutputError(fmt::format("cannot write '{}': expected a file, found {}", path.string(),
                                      kind_of(type)));
    std::filesystem::path target = path; // which may not be there yet
    for (int links = 0; std::filesystem::is_symlink(target, error); ++links) {
        if (links == 40) fail("write", path, ELOOP);
        target = target.parent_path() / std::filesystem::read_symlink(target, error);
    }
    return target;
}

std::filesystem::path temporary_name(const std::filesystem::path& path) {
    std::filesystem::path name = path;
    name += fmt::format(".{}.tmp", getpid());
    return name;
}

std::string read_whole(const std::filesystem::path& path) {
    require_regular_file(path);
    const File file(std::fopen(path.c_str(), "rb"));
    if (!file) fail("read", path, errno);
    std::string content;
    char block[1 << 14];
    while (const std::size_t n = std::fread(block, 1, sizeof block, file.get()))
        content.append(block, n);
    if (std::ferror(file.get())) fail("read", path, errno);
    return content;
}

std::string_view without_mark(std::string_view text) {
    constexpr std::string_view mark = "\xef\xbb\xbf";
    if (text.starts_with(mark)) text.remove_prefix(mark.size());
    return text;
}

std::string read_text(const std::filesystem::path& path) {
    try {
        return as_utf8(read_whole(path));
    } catch (const InputError& e) {
        throw InputError(fmt::format("{}: {}", path.string(), e.what()));
    }
}

void write_whole(const std::filesystem::path& name, std::string_view content) {
    if (!Ranks::writes()) return;
    UnfinishedFile unfinished(name);
    File file(std::fopen(unfinished.path().c_str(), "wb"));
    if (!file) fail("write", name, errno);
    errno = 0;
    const bool written =
        std::fwrite(content.data(), 1, content.size(), file.get()) == content.size() &&
        std::fflush(file.get()) == 0 && fsync(fileno(file.get())) == 0;
    int problem = written ? 0 : errno;
    if (std::fclose(file.release()) != 0 && problem == 0) problem = errno;
    if (problem != 0 || !written) fail("write", name, problem);
    unfinished.put_in_place();
}

} // namespace bris

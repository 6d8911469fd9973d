#include "engine/io/seal.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <sys/stat.h>
#include <unistd.h>

namespace bris {

namespace {

namespace fs = std::filesystem;

/// The last bytes of a sealed file; the list of ranges stands before it.
struct Seal {
    std::array<char, 8> mark{'B', 'R', 'I', 'S', 's', 'e', 'a', 'l'};
    std::uint64_t ranges = 0;
    std::uint64_t hash = 0; ///< of all bytes before the seal that are in none of the ranges
};
static_assert(sizeof(Seal) == 24 && sizeof(FileRange) == 16);

constexpr std::array<char, 8> mark_until_format_4{'B', 'R', 'I', 'S', 'c', 'k', 'p', '\n'};

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

[[noreturn]] void fail(const char* doing, const fs::path& path) {
    throw OutputError(fmt::format("cannot {} '{}': {}", doing, path.string(),
                                  std::strerror(errno == 0 ? EIO : errno)));
}

[[noreturn]] void reject(const fs::path& path, const std::string& what) {
    throw InputError(fmt::format("checkpoint '{}': {}", path.string(), what));
}

std::uint64_t size_of(std::FILE* file, const fs::path& path) {
    struct stat status {};
    if (fstat(fileno(file), &status) != 0) fail("read", path);
    return static_cast<std::uint64_t>(status.st_size);
}

void go_to(std::FILE* file, std::uint64_t position, const fs::path& path) {
    errno = 0;
    if (fseeko(file, static_cast<off_t>(position), SEEK_SET) != 0) fail("read", path);
}

/// Adds a range of the file, read block by block, to the hash. Each operation is invertible, so
/// that no information is lost.
std::uint64_t add_to_hash(std::uint64_t hash, std::FILE* file, FileRange range,
                          const fs::path& path) {
    std::vector<std::uint64_t> block(std::size_t{1} << 14);
    go_to(file, range.first, path);
    hash ^= range.bytes;
    while (range.bytes > 0) {
        const std::size_t bytes =
            std::min<std::uint64_t>(range.bytes, block.size() * sizeof(block[0]));
        std::fill(block.begin(), block.end(), 0);
        errno = 0;
        if (std::fread(block.data(), 1, bytes, file) != bytes) fail("read", path);
        for (std::size_t i = 0; i < (bytes + 7) / 8; ++i) {
            hash = (hash ^ block[i]) * 0xff51afd7ed558ccdu;
            hash ^= hash >> 32;
        }
        range.bytes -= bytes;
    }
    return hash;
}

/// Hash of the first `size` bytes of a file without the ranges, and of the list of them.
std::uint64_t hash_outside(std::FILE* file, std::uint64_t size, const std::vector<FileRange>& apart,
                           const fs::path& path) {
    std::uint64_t hash = size, at = 0;
    for (const FileRange& range : apart) {
        hash = add_to_hash(hash, file, {at, range.first - at}, path);
        hash = (hash ^ range.bytes) * 0xff51afd7ed558ccdu;
        at = range.first + range.bytes;
    }
    return add_to_hash(hash, file, {at, size - at}, path);
}

bool are_in_order(const std::vector<FileRange>& ranges, std::uint64_t size) {
    std::uint64_t at = 0;
    for (const FileRange& range : ranges) {
        if (range.first < at || range.bytes > size || range.first > size - range.bytes)
            return false;
        at = range.first + range.bytes;
    }
    return true;
}

} // namespace

void seal_file(const fs::path& path, const std::vector<FileRange>& checked_by_reader) {
    errno = 0;
    const File file(std::fopen(path.c_str(), "r+b"));
    if (!file) fail("write", path);
    Seal seal;
    seal.ranges = checked_by_reader.size();
    seal.hash = hash_outside(file.get(), size_of(file.get(), path), checked_by_reader, path);
    errno = 0;
    if (std::fseek(file.get(), 0, SEEK_END) != 0 ||
        std::fwrite(checked_by_reader.data(), sizeof(FileRange), checked_by_reader.size(),
                    file.get()) != checked_by_reader.size() ||
        std::fwrite(&seal, sizeof seal, 1, file.get()) != 1 || std::fflush(file.get()) != 0 ||
        fsync(fileno(file.get())) != 0)
        fail("write", path);
}

void check_seal(const fs::path& path) {
    require_regular_file(path);
    errno = 0;
    const File file(std::fopen(path.c_str(), "rb"));
    if (!file) fail("read", path);
    const std::uint64_t size = size_of(file.get(), path);
    Seal seal;
    if (size <= sizeof seal)
        reject(path, fmt::format("expected a checkpoint, found {} bytes", size));
    go_to(file.get(), size - sizeof seal, path);
    if (std::fread(&seal, sizeof seal, 1, file.get()) != 1) fail("read", path);
    // the seal before had 16 bytes
    if (std::memcmp(reinterpret_cast<const char*>(&seal) + 8, mark_until_format_4.data(), 8) == 0)
        reject(path, "expected format 5, found an earlier one, which this version cannot continue");
    if (seal.mark != Seal{}.mark)
        reject(path,
               "expected a complete checkpoint, found a truncated file or one of another kind");
    const std::string damage = "expected content that matches its hash, found damage";
    const std::uint64_t before = size - sizeof seal;
    if (seal.ranges > before / sizeof(FileRange)) reject(path, damage);
    const std::uint64_t content = before - seal.ranges * sizeof(FileRange);
    std::vector<FileRange> ranges(seal.ranges);
    go_to(file.get(), content, path);
    if (std::fread(ranges.data(), sizeof(FileRange), ranges.size(), file.get()) != ranges.size())
        fail("read", path);
    if (!are_in_order(ranges, content) ||
        hash_outside(file.get(), content, ranges, path) != seal.hash)
        reject(path, damage);
}

} // namespace bris

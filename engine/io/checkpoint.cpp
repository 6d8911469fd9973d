#include "engine/io/checkpoint.hpp"

#include "engine/errors.hpp"
#include "engine/io/hdf5.hpp"
#include "engine/io/unfinished_file.hpp"
#include "engine/io/whole_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <sys/stat.h>
#include <unistd.h>

namespace bris {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t format_version = 4;

struct Seal {
    std::array<char, 8> mark{'B', 'R', 'I', 'S', 'c', 'k', 'p', '\n'};
    std::uint64_t hash = 0; ///< of all bytes before the seal
};
static_assert(sizeof(Seal) == 16);

struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

[[noreturn]] void fail(const char* doing, const fs::path& path, int error) {
    throw OutputError(
        fmt::format("cannot {} '{}': {}", doing, path.string(), std::strerror(error)));
}

[[noreturn]] void reject(const fs::path& path, const std::string& what) {
    throw InputError(fmt::format("checkpoint '{}': {}", path.string(), what));
}

/// Whether two settings are paths of one file or folder, or of files with the same content.
bool same_file(const std::string& a, const std::string& b) {
    std::error_code error;
    if (!fs::exists(a, error) || !fs::exists(b, error)) return false;
    if (fs::equivalent(a, b, error)) return true;
    return fs::is_regular_file(a, error) && fs::is_regular_file(b, error) &&
           read_whole(a) == read_whole(b);
}

/// Hash of the next `size` bytes of a file, read block by block.
std::uint64_t hash_of(std::FILE* file, std::uint64_t size, const fs::path& path) {
    std::vector<std::uint64_t> block(std::size_t{1} << 14);
    std::uint64_t hash = size;
    while (size > 0) {
        const std::size_t bytes = std::min<std::uint64_t>(size, block.size() * sizeof(block[0]));
        std::fill(block.begin(), block.end(), 0);
        errno = 0;
        if (std::fread(block.data(), 1, bytes, file) != bytes)
            fail("read", path, errno == 0 ? EIO : errno);
        // each operation is invertible, so that no information is lost
        for (std::size_t i = 0; i < (bytes + 7) / 8; ++i) {
            hash = (hash ^ block[i]) * 0xff51afd7ed558ccdu;
            hash ^= hash >> 32;
        }
        size -= bytes;
    }
    return hash;
}

std::uint64_t size_of(std::FILE* file, const fs::path& path) {
    struct stat status {};
    if (fstat(fileno(file), &status) != 0) fail("read", path, errno);
    return static_cast<std::uint64_t>(status.st_size);
}

void check_seal(const fs::path& path) {
    require_regular_file(path);
    const File file(std::fopen(path.c_str(), "rb"));
    if (!file) fail("read", path, errno);
    const std::uint64_t size = size_of(file.get(), path);
    Seal found;
    found.mark.fill(0);
    if (size <= sizeof(Seal))
        reject(path, fmt::format("expected a checkpoint, found {} bytes", size));
    const std::uint64_t hash = hash_of(file.get(), size - sizeof(Seal), path);
    if (std::fread(&found, sizeof found, 1, file.get()) != 1) fail("read", path, EIO);
    if (found.mark != Seal{}.mark)
        reject(path,
               "expected a complete checkpoint, found a truncated file or one of another kind");
    if (found.hash != hash) reject(path, "expected content that matches its hash, found damage");
}

/// Appends the seal and waits until the whole file is on disk.
void seal(const fs::path& path) {
    const File file(std::fopen(path.c_str(), "r+b"));
    if (!file) fail("write", path, errno);
    Seal seal;
    seal.hash = hash_of(file.get(), size_of(file.get(), path), path);
    errno = 0;
    if (std::fseek(file.get(), 0, SEEK_END) != 0 ||
        std::fwrite(&seal, sizeof seal, 1, file.get()) != 1 || std::fflush(file.get()) != 0 ||
        fsync(fileno(file.get())) != 0)
        fail("write", path, errno == 0 ? EIO : errno);
}

/// Waits until a new name in the directory is on disk.
void synchronise_directory(const fs::path& directory) {
    const int handle = open(directory.empty() ? "." : directory.c_str(), O_RDONLY | O_DIRECTORY);
    // the file is complete under one of its names; nothing more can be done
    if (handle < 0) return;
    fsync(handle);
    close(handle);
}

template <class T>
void write_array(Hdf5File& file, const Archive::Array& array) {
    std::vector<T> values(array.bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), array.bytes.data(), array.bytes.size());
    file.write<T>("/state/" + array.path, values, {array.rows(), array.columns});
}

template <class T>
void read_array(const Hdf5File& file, Archive::Array& array) {
    const auto values = file.read<T>("/state/" + array.path);
    array.bytes.resize(values.size() * sizeof(T));
    if (!values.empty()) std::memcpy(array.bytes.data(), values.data(), array.bytes.size());
}

/// Calls `with(T{})` for the type that represents the numbers of an array in the file.
template <class Action>
void dispatch(Scalar scalar, std::size_t size, Action&& with) {
    if (scalar == Scalar::real && size == 8)
        with(double{});
    else if (scalar == Scalar::real && size == 4)
        with(float{});
    else if (scalar == Scalar::integer && size == 8)
        with(std::uint64_t{});
    else if (scalar == Scalar::integer && size == 4)
        with(std::uint32_t{});
    else if (scalar == Scalar::integer && size == 1)
        with(std::uint8_t{});
    else
        throw std::logic_error(fmt::format("checkpoints do not support numbers of {} bytes", size));
}

void write_content(const fs::path& path, const Checkpoint& checkpoint) {
    Hdf5File file = Hdf5File::create(path);
    file.make_group("/state");
    file.make_group("/settings");
    std::string order, keys; // HDF5 lists names alphabetically, so the order is kept as text
    for (const Archive::Array& array : checkpoint.state.arrays()) {
        dispatch(array.scalar, array.scalar_size,
                 [&](auto number) { write_array<decltype(number)>(file, array); });
        order += fmt::format("{} {} {}\n", array.path,
                             array.scalar == Scalar::real ? "real" : "integer", array.scalar_size);
    }
    for (const NamedValue& entry : checkpoint.settings) {
        file.set_attribute("/settings", entry.key, entry.text());
        keys += entry.key + "\n";
    }
    file.set_attribute("/", "bris_checkpoint", format_version);
    file.set_attribute("/", "scenario", checkpoint.scenario);
    file.set_attribute("/", "step", checkpoint.step);
    file.set_attribute("/", "fingerprint", fingerprint(checkpoint.state));
    file.set_attribute("/", "arrays", order);
    file.set_attribute("/", "settings", keys);
    file.close();
}

Archive read_state(const Hdf5File& file) {
    Archive state;
    std::istringstream order(file.text_attribute("/", "arrays"));
    std::string path, scalar;
    std::size_t size = 0;
    while (order >> path >> scalar >> size) {
        const auto shape = file.shape("/state/" + path);
        if (shape.size() != 2)
            throw OutputError(fmt::format("{}: expected a table, found {}", path, in_words(shape)));
        Archive::Array array{path,
                             scalar == "real" ? Scalar::real : Scalar::integer,
                             size,
                             static_cast<std::size_t>(shape[1]),
                             {}};
        dispatch(array.scalar, size,
                 [&](auto number) { read_array<decltype(number)>(file, array); });
        state.put(std::move(array));
    }
    return state;
}

Checkpoint read_content(const fs::path& path) {
    const Hdf5File file = Hdf5File::open(path);
    const auto number = [&](const std::string& name) {
        return file.attribute<std::uint64_t>("/", name).at(0);
    };
    if (const auto version = number("bris_checkpoint"); version != format_version)
        reject(path, fmt::format("expected format {}, found {}", format_version, version));
    Checkpoint checkpoint;
    checkpoint.scenario = file.text_attribute("/", "scenario");
    checkpoint.step = number("step");
    std::istringstream keys(file.text_attribute("/", "settings"));
    for (std::string key; std::getline(keys, key);)
        checkpoint.settings.emplace_back(key, file.text_attribute("/settings", key));
    checkpoint.state = read_state(file);
    if (const auto saved = number("fingerprint"), found = fingerprint(checkpoint.state);
        found != saved)
        reject(path, fmt::format("expected a state with the fingerprint {:016x}, found {:016x}",
                                 saved, found));
    return checkpoint;
}

} // namespace

void write_checkpoint(const std::filesystem::path& name, const Checkpoint& checkpoint) {
    const Saving saving;
    const fs::path path = file_to_write(name);
    try {
        UnfinishedFile unfinished(path);
        write_content(unfinished.path(), checkpoint);
        seal(unfinished.path());
        unfinished.put_in_place();
    } catch (const OutputError& problem) {
        throw OutputError(
            fmt::format("cannot write checkpoint '{}': {}", path.string(), problem.what()));
    }
    synchronise_directory(path.parent_path());
}

Checkpoint read_checkpoint(const std::filesystem::path& path) {
    check_seal(path);
    try {
        return read_content(path);
        // the seal is intact, so the content was wrong when it was written
    } catch (const OutputError& problem) {
        reject(path, fmt::format("expected a checkpoint written by this program, found: {}",
                                 problem.what()));
    }
}

void require_same_run(const std::string& option, const std::filesystem::path& path,
                      const Checkpoint& checkpoint, const std::string& scenario,
                      const std::vector<NamedValue>& settings,
                      std::span<const std::string_view> may_differ) {
    const std::string where = fmt::format("{} {}", option, path.string());
    require(checkpoint.scenario == scenario,
            fmt::format("{}: expected a checkpoint of {}, found one of {}", where, scenario,
                        checkpoint.scenario));
    std::string made, asked; // the settings that differ
    const auto compare = [&](const NamedValue& any, const NamedValue* before,
                             const NamedValue* now) {
        if (std::ranges::count(may_differ, any.key) > 0) return;
        const std::string then = before ? before->text() : "", here = now ? now->text() : "";
        if (then == here || same_file(then, here)) return;
        const std::string& name = any.flag.empty() ? any.key : any.flag;
        const auto with = [&](const std::string& value) {
            return value.empty() ? "no " + name : name + " " + value;
        };
        made += (made.empty() ? "" : ", ") + with(then);
        asked += (asked.empty() ? "" : ", ") + with(here);
    };
    const auto find = [](const std::vector<NamedValue>& list, const std::string& key) {
        const auto at = std::ranges::find(list, key, &NamedValue::key);
        return at == list.end() ? nullptr : &*at;
    };
    for (const NamedValue& now : settings) compare(now, find(checkpoint.settings, now.key), &now);
    for (const NamedValue& before : checkpoint.settings)
        if (find(settings, before.key) == nullptr) compare(before, &before, nullptr);
    require(made.empty(),
            fmt::format("{}: the {} was made with {}; this run asks for {}", where,
                        scenario == "specimen" ? scenario : "checkpoint", made, asked));
}

std::span<const std::string_view> settings_that_may_differ() {
    static constexpr std::array<std::string_view, 11> keys{
        "out",    "assets",  "threads", "ranks", "memory_GiB", "config",
        "resume", "explain", "serial",  "quiet", "write"};
    return keys;
}

} // namespace bris

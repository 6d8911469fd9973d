#include "engine/io/checkpoint.hpp"

#include "engine/errors.hpp"
#include "engine/io/hdf5.hpp"
#include "engine/io/seal.hpp"
#include "engine/io/unfinished_file.hpp"
#include "engine/ranks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fcntl.h>
#include <sstream>
#include <stdexcept>
#include <unistd.h>

namespace bris {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t format_version = 5;

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

/// Waits until a new name in the directory is on disk.
void synchronise_directory(const fs::path& directory) {
    const int handle = open(directory.empty() ? "." : directory.c_str(), O_RDONLY | O_DIRECTORY);
    // the file is complete under one of its names; nothing more can be done
    if (handle < 0) return;
    fsync(handle);
    close(handle);
}

/// Bytes as numbers.
template <class T>
std::span<T> numbers_in(std::vector<std::byte>& bytes) {
    return {reinterpret_cast<T*>(bytes.data()), bytes.size() / sizeof(T)};
}
template <class T>
std::span<const T> numbers_in(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
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

constexpr auto block_columns = 3; ///< of /blocks: index of the first array, number of ids, hash

/// Writes State as its pieces pass.
class StateWriter {
public:
    explicit StateWriter(Hdf5File& file) : file_(file) {}

    void write(const StatePiece& piece) {
        const Archive::Array& array = *piece.array;
        const std::string path = "/state/" + array.path;
        dispatch(array.scalar, array.scalar_size, [&]<class T>(T) {
            if (piece.first_row == 0) file_.make<T>(path, {piece.rows_of_table, array.columns});
            file_.write_rows(path, piece.first_row, numbers_in<T>(piece.bytes));
        });
        hashes_.add(piece);
    }
    /// Writes what is known at the end. Returns where the bytes of the arrays are in the file.
    std::vector<FileRange> finish() {
        std::string order; // HDF5 lists names alphabetically, so the order is kept as text
        std::vector<FileRange> ranges;
        for (const Archive::Array& array : hashes_.arrays().arrays()) {
            order += fmt::format("{} {} {} {}\n", array.path,
                                 array.scalar == Scalar::real ? "real" : "integer",
                                 array.scalar_size, array.key.empty() ? "-" : array.key);
            if (const FileRange range = file_.range_of("/state/" + array.path); range.bytes > 0)
                ranges.push_back(range);
        }
        std::vector<std::uint64_t> table;
        for (const StateBlock& block : hashes_.blocks())
            table.insert(table.end(), {block.array, block.ids, block.hash});
        file_.write("/blocks", std::span<const std::uint64_t>(table),
                    {hashes_.blocks().size(), block_columns});
        file_.set_attribute("/", "arrays", order);
        file_.set_attribute("/", "fingerprint", hashes_.fingerprint());
        std::ranges::sort(ranges, {}, &FileRange::first);
        return ranges;
    }

private:
    Hdf5File& file_;
    StateHashes hashes_;
};

std::vector<FileRange> write_content(const fs::path& path, const Checkpoint& checkpoint,
                                     const StateSource* state) {
    Hdf5File file = Hdf5File::create(path);
    file.make_group("/state");
    file.make_group("/settings");
    StateWriter writer(file);
    if (state != nullptr) state->for_pieces([&](const StatePiece& piece) { writer.write(piece); });
    for_pieces(checkpoint.state, [&](const StatePiece& piece) { writer.write(piece); });
    const auto ranges = writer.finish();
    std::string keys;
    for (const NamedValue& entry : checkpoint.settings) {
        if (std::ranges::count(settings_that_may_differ(), entry.key) > 0) continue;
        file.set_attribute("/settings", entry.key, entry.text());
        keys += entry.key + "\n";
    }
    file.set_attribute("/", "bris_checkpoint", format_version);
    file.set_attribute("/", "scenario", checkpoint.scenario);
    file.set_attribute("/", "step", checkpoint.step);
    file.set_attribute("/", "settings", keys);
    file.close();
    return ranges;
}

Archive read_state(const Hdf5File& file) {
    Archive state;
    std::istringstream order(file.text_attribute("/", "arrays"));
    std::string path, scalar, key;
    std::size_t size = 0;
    while (order >> path >> scalar >> size >> key) {
        const auto shape = file.shape("/state/" + path);
        if (shape.size() != 2)
            throw OutputError(fmt::format("{}: expected a table, found {}", path, in_words(shape)));
        Archive::Array array{path, scalar == "real" ? Scalar::real : Scalar::integer,
                             size, static_cast<std::size_t>(shape[1]),
                             {},   key == "-" ? "" : key};
        array.bytes.resize(shape[0] * shape[1] * size);
        dispatch(array.scalar, size,
                 [&]<class T>(T) { file.read_into("/state/" + path, numbers_in<T>(array.bytes)); });
        state.put(std::move(array));
    }
    return state;
}

/// The blocks of what was read. Throws InputError unless they are those that were written.
std::vector<StateBlock> checked_blocks(const Hdf5File& file, const Archive& state,
                                       const fs::path& path) {
    const auto written = file.read<std::uint64_t>("/blocks");
    std::vector<StateBlock> found = hash_blocks(state);
    if (written.size() != found.size() * block_columns)
        reject(path, fmt::format("expected {} blocks of State, found {}",
                                 written.size() / block_columns, found.size()));
    for (std::size_t k = 0; k < found.size(); ++k) {
        const std::uint64_t* row = &written[block_columns * k];
        if (StateBlock{row[0], static_cast<std::uint32_t>(row[1]), row[2]} == found[k]) continue;
        const Archive::Array& array = state.arrays()[found[k].array];
        const std::string table = array.path.substr(0, array.path.rfind('/'));
        reject(path, fmt::format("expected content that matches its hash, found damage in {}{}",
                                 array.key.empty() ? array.path : table,
                                 array.key.empty()
                                     ? ""
                                     : fmt::format(", ids from {}", row[1] * ids_per_block)));
    }
    return found;
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
    const auto blocks = checked_blocks(file, checkpoint.state, path);
    if (const auto saved = number("fingerprint"), found = fingerprint(checkpoint.state, blocks);
        found != saved)
        reject(path, fmt::format("expected a state with the fingerprint {:016x}, found {:016x}",
                                 saved, found));
    return checkpoint;
}

} // namespace

void write_checkpoint(const std::filesystem::path& name, const Checkpoint& checkpoint,
                      const StateSource* state) {
    if (!Ranks::writes()) {
        if (state != nullptr) state->for_pieces({});
        (void)Ranks::writes(); // the ranks may have met since, and the file is not complete
        return;
    }
    const Saving saving;
    const fs::path path = file_to_write(name);
    try {
        UnfinishedFile unfinished(path);
        seal_file(unfinished.path(), write_content(unfinished.path(), checkpoint, state));
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
        "out",    "assets", "beds",    "threads", "ranks", "memory_GiB",
        "config", "resume", "explain", "quiet",   "write"};
    return keys;
}

} // namespace bris

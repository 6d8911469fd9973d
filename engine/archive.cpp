#include "engine/archive.hpp"

#include "engine/errors.hpp"
#include "engine/running_hash.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

std::uint64_t mix_bytes(std::uint64_t h, const std::byte* data, std::size_t size) {
    for (; size >= 8; data += 8, size -= 8) {
        std::uint64_t word;
        std::memcpy(&word, data, 8);
        h = mix(h, word);
    }
    std::uint64_t tail = 0;
    if (size > 0) std::memcpy(&tail, data, size);
    return mix(h, tail + size);
}

/// The id of each row, by its first number; empty: the rows have none.
std::vector<std::uint32_t> ids_of(const Archive& archive, const std::string& key) {
    if (key.empty()) return {};
    const auto* array = archive.find(key);
    require(array != nullptr && array->scalar_size == sizeof(std::uint32_t) && array->columns > 0,
            "checkpoint: expected the ids '" + key + "', found none");
    std::vector<std::uint32_t> ids(array->rows());
    for (std::size_t row = 0; row < ids.size(); ++row)
        std::memcpy(&ids[row], array->bytes.data() + row * array->columns * sizeof(ids[0]),
                    sizeof(ids[0]));
    return ids;
}

} // namespace

void require_numbers(const std::string& path, std::size_t expected, std::size_t found) {
    require(found == expected,
            fmt::format("{}: expected {} numbers, found {}: this checkpoint is of another version "
                        "of BRIS",
                        path, expected, found));
}

const Archive::Array* Archive::find(const std::string& path) const {
    for (const Array& array : arrays_)
        if (array.path == path) return &array;
    return nullptr;
}

const Archive::Array& Archive::checked(const std::string& path, std::size_t scalar_size) const {
    const Array* array = find(path);
    require(array != nullptr, "checkpoint: expected an array '" + path + "', found none");
    require(array->scalar_size == scalar_size,
            "checkpoint: '" + path + "' has numbers of a different size");
    return *array;
}

void for_pieces(const Archive& archive, const std::function<void(const StatePiece&)>& visit) {
    const auto& all = archive.arrays();
    for (std::size_t first = 0, end = 0; first < all.size(); first = end) {
        const std::string& key = all[first].key;
        for (end = first + 1; !key.empty() && end < all.size() && all[end].key == key;) ++end;
        const std::span table(all.data() + first, end - first);
        const std::vector<std::uint32_t> ids = ids_of(archive, key);
        const std::size_t rows = key.empty() ? all[first].rows() : ids.size();
        for (const auto& array : table)
            require(array.rows() == rows,
                    fmt::format("checkpoint: '{}': expected {} rows, found {}", array.path, rows,
                                array.rows()));
        std::size_t row = 0;
        do { // arrays without rows have one piece, for their shape
            const std::uint32_t block = ids.empty() ? 0 : ids[row] / ids_per_block;
            std::size_t next = ids.empty() ? rows : row;
            while (next < ids.size() && ids[next] / ids_per_block == block) ++next;
            for (std::size_t k = 0; k < table.size(); ++k) {
                const std::size_t width = table[k].width();
                visit(
                    {.array = &table[k],
                     .bytes = std::span(table[k].bytes).subspan(row * width, (next - row) * width),
                     .number = k,
                     .arrays = table.size(),
                     .ids = block,
                     .first_row = row,
                     .rows_of_table = rows});
            }
            row = next;
        } while (row < rows);
    }
}

void BlockHashes::add(const StatePiece& piece) {
    const Archive::Array& array = *piece.array;
    if (piece.number == 0) {
        if (piece.first_row == 0) {
            present_.array = arrays_;
            arrays_ += piece.arrays;
        }
        present_.ids = piece.ids;
        present_.hash = 0x62726973;
        is_hashed_ = false;
    }
    if (array.path.starts_with(prefix_)) {
        const std::uint64_t shaped = mix(mix(present_.hash, array.scalar_size), array.columns);
        present_.hash = mix_bytes(shaped, piece.bytes.data(), piece.bytes.size());
        is_hashed_ = true;
    }
    if (is_hashed_ && piece.number + 1 == piece.arrays) blocks_.push_back(present_);
}

std::vector<StateBlock> hash_blocks(const Archive& archive, const std::string& prefix) {
    BlockHashes hashes(prefix);
    for_pieces(archive, [&](const StatePiece& piece) { hashes.add(piece); });
    return hashes.blocks();
}

std::uint64_t fingerprint(const Archive& archive, const std::vector<StateBlock>& blocks) {
    std::uint64_t h = 0x62726973;
    for (const StateBlock& block : blocks)
        if (!archive.arrays()[block.array].path.starts_with("guard/"))
            h = mix(mix(h, block.ids), block.hash);
    return h;
}

std::uint64_t fingerprint(const Archive& archive, const std::string& prefix) {
    return fingerprint(archive, hash_blocks(archive, prefix));
}

std::string hexadecimal(std::uint64_t fingerprint) { return fmt::format("{:016x}", fingerprint); }

} // namespace bris

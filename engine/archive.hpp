#pragma once

#include "engine/component.hpp"

#include <array>
#include <cstddef>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace bris {

/// State laid out as named arrays: the content of a checkpoint, of a snapshot in memory and of a
/// fingerprint. An array has rows x columns of one scalar type; its rows are in the order of the
/// ids.
class Archive {
public:
    struct Array {
        std::string path; ///< for example "bodies/position"
        Scalar scalar;
        std::size_t scalar_size; ///< bytes
        std::size_t columns;
        std::vector<std::byte> bytes;
        /// Path of the array that holds the ids of the rows, of which the first number counts (32
        /// bits, ascending); empty: the rows have none.
        std::string key = {};
        std::size_t width() const { return scalar_size * columns; } ///< bytes of a row
        std::size_t rows() const { return bytes.size() / width(); }
    };

    void put(Array array) { arrays_.push_back(std::move(array)); }
    /// The array of that path; null if there is none.
    const Array* find(const std::string& path) const;
    const std::vector<Array>& arrays() const { return arrays_; }

    /// Stores numbers as an array with one column.
    template <class T>
    void put(const std::string& path, std::span<const T> values) {
        static_assert(std::is_arithmetic_v<T>);
        Array array{path, std::is_integral_v<T> ? Scalar::integer : Scalar::real, sizeof(T), 1, {}};
        array.bytes.resize(values.size_bytes());
        if (!values.empty()) std::memcpy(array.bytes.data(), values.data(), values.size_bytes());
        put(std::move(array));
    }
    /// Reads back an array stored by `put`. Throws InputError if the array is missing or its
    /// numbers have a different size.
    template <class T>
    std::vector<T> get(const std::string& path) const {
        const Array& array = checked(path, sizeof(T));
        std::vector<T> values(array.bytes.size() / sizeof(T));
        if (!values.empty()) std::memcpy(values.data(), array.bytes.data(), array.bytes.size());
        return values;
    }

private:
    const Array& checked(const std::string& path, std::size_t scalar_size) const;
    std::vector<Array> arrays_;
};

/// Throws InputError if an array of a checkpoint has not as many numbers as this version expects.
void require_numbers(const std::string& path, std::size_t expected, std::size_t found);

/// Stores a tuple of references to numbers and flags as one array of doubles; get_fields reads it
/// back, and refuses one of another length.
template <class... Fields>
void put_fields(Archive& archive, const std::string& path,
                const std::tuple<const Fields&...>& fields) {
    const auto numbers = std::apply(
        [](auto&... field) { return std::array{static_cast<double>(field)...}; }, fields);
    archive.put(path, std::span<const double>(numbers));
}
template <class... Fields>
void get_fields(const Archive& archive, const std::string& path,
                const std::tuple<Fields&...>& fields) {
    const auto numbers = archive.get<double>(path);
    require_numbers(path, sizeof...(Fields), numbers.size());
    std::size_t next = 0;
    std::apply([&](auto&... field) { ((field = static_cast<Fields>(numbers.at(next++))), ...); },
               fields);
}

inline constexpr std::uint32_t ids_per_block = 65536;

/// The hash of a block of State: the rows of one table whose ids begin with the same 65 536, or an
/// array without ids.
struct StateBlock {
    std::size_t array;     ///< index of the first array of the table
    std::uint32_t ids = 0; ///< the block begins with the id 65 536 times this
    std::uint64_t hash = 0;
    bool operator==(const StateBlock&) const = default;
};

/// What is hashed and written of State at once: the rows of such a block in one array.
struct StatePiece {
    const Archive::Array* array = nullptr; ///< whose bytes do not matter here
    std::span<const std::byte> bytes = {};
    std::size_t number = 0, arrays = 1; ///< which of how many arrays of the table
    std::uint32_t ids = 0;              ///< as in StateBlock
    std::size_t first_row = 0, rows_of_table = 0;
    /// The array without rows.
    Archive::Array layout() const {
        return {array->path, array->scalar, array->scalar_size, array->columns, {}, array->key};
    }
};
/// Calls visit(piece) for all pieces of an archive in the order of tables, ids and arrays. Throws
/// InputError if the arrays of a table differ in their number of rows.
void for_pieces(const Archive& archive, const std::function<void(const StatePiece&)>& visit);

/// The hashes of the shapes and values of blocks whose pieces pass in that order: of their arrays
/// whose path starts with `prefix`, and of blocks that have such.
class BlockHashes {
public:
    explicit BlockHashes(std::string prefix = "") : prefix_(std::move(prefix)) {}
    void add(const StatePiece& piece);
    const std::vector<StateBlock>& blocks() const { return blocks_; }

private:
    std::string prefix_;
    std::vector<StateBlock> blocks_;
    StateBlock present_ = {};
    std::size_t arrays_ = 0; // of the tables so far
    bool is_hashed_ = false; // whether the present block has such arrays
};

/// The blocks of all arrays whose path starts with `prefix`, in the order of arrays and ids. Each
/// can be hashed by whoever holds its rows. Throws as for_pieces.
std::vector<StateBlock> hash_blocks(const Archive& archive, const std::string& prefix = "");

/// 64-bit hash of the shapes and values of those blocks, in their order. Names are left out, so
/// that renaming a table or a column keeps the fingerprint. Arrays whose path starts with "guard/"
/// are left out too: they can stop a run, but no motion depends on them.
std::uint64_t fingerprint(const Archive& archive, const std::vector<StateBlock>& blocks);
std::uint64_t fingerprint(const Archive& archive, const std::string& prefix = "");
/// A fingerprint as 16 hexadecimal digits.
std::string hexadecimal(std::uint64_t fingerprint);

} // namespace bris

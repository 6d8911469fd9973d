#pragma once

#include "engine/component.hpp"

#include <array>
#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <tuple>
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
        std::size_t rows() const { return bytes.size() / (scalar_size * columns); }
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

/// The blocks of all arrays whose path starts with `prefix`, in the order of arrays and ids. Each
/// can be hashed by whoever holds its rows. Throws InputError if the arrays of a table differ in
/// their number of rows.
std::vector<StateBlock> hash_blocks(const Archive& archive, const std::string& prefix = "");

/// 64-bit hash of the shapes and values of those blocks, in their order. Names are left out, so
/// that renaming a table or a column keeps the fingerprint. Arrays whose path starts with "guard/"
/// are left out too: they can stop a run, but no motion depends on them.
std::uint64_t fingerprint(const Archive& archive, const std::vector<StateBlock>& blocks);
std::uint64_t fingerprint(const Archive& archive, const std::string& prefix = "");
/// A fingerprint as 16 hexadecimal digits.
std::string hexadecimal(std::uint64_t fingerprint);

} // namespace bris

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

/// State laid out as named arrays: what a checkpoint writes, a snapshot keeps and a fingerprint
/// hashes. Arrays are rows x columns of one scalar, rows in id order.
class Archive {
public:
    struct Array {
        std::string path; ///< as "bodies/position"
        Scalar scalar;
        std::size_t scalar_size; ///< bytes
        std::size_t columns;
        std::vector<std::byte> bytes;
        std::size_t rows() const { return bytes.size() / (scalar_size * columns); }
    };

    void put(Array array) { arrays_.push_back(std::move(array)); }
    /// Null if there is none of that path.
    const Array* find(const std::string& path) const;
    const std::vector<Array>& arrays() const { return arrays_; }

    /// Stores plain numbers, one column.
    template <class T>
    void put(const std::string& path, std::span<const T> values) {
        static_assert(std::is_arithmetic_v<T>);
        Array array{path, std::is_integral_v<T> ? Scalar::integer : Scalar::real, sizeof(T), 1, {}};
        array.bytes.resize(values.size_bytes());
        if (!values.empty()) std::memcpy(array.bytes.data(), values.data(), values.size_bytes());
        put(std::move(array));
    }
    /// Reads back what `put` stored. Throws InputError if it is missing or of another size.
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

/// Stores a few fields (a tuple of references to numbers and flags) as one array; reads them back.
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
    std::size_t next = 0;
    std::apply([&](auto&... field) { ((field = static_cast<Fields>(numbers.at(next++))), ...); },
               fields);
}

/// 64-bit hash of the shapes and values, in their order, of all arrays whose path starts with
/// `prefix`. Names are left out, so that renaming a table or a column keeps the fingerprint.
std::uint64_t fingerprint(const Archive& archive, const std::string& prefix = "");
/// Sixteen hexadecimal digits of it.
std::string hexadecimal(std::uint64_t fingerprint);

} // namespace bris

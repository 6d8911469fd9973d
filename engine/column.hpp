#pragma once

#include "engine/component.hpp"
#include "engine/entity.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <typeindex>
#include <utility>

namespace bris {

/// Whether both are the same type. BRIS is one binary, in which a type has one name at one address;
/// the == of std::type_index would also compare the texts of different names.
inline bool same_type(std::type_index a, std::type_index b) { return a.name() == b.name(); }

/// One component of every row of a table, 64-byte aligned; new rows are zero, except those of
/// scratch columns, which have any value. Values are moved with memcpy, so a component's value must
/// be plain data.
class Column {
public:
    struct Type {
        std::type_index component;
        std::string name, unit;
        bool is_state;
        Scalar scalar;
        std::size_t scalar_size; ///< bytes
        std::size_t value_size;  ///< bytes
        bool is_key = false, is_scratch = false;
        bool is_carried = false; ///< copied with rows: State, and Derived values marked so
        bool (*keep)(const std::byte* value) = nullptr; ///< null: every row is saved
    };

    explicit Column(Type type) : type_(std::move(type)) {}
    Column(const Column& other);
    /// Some rows of another column, in this order; as many zeros if it is not carried.
    Column(const Column& other, std::span<const Row> rows);
    Column& operator=(const Column&) = delete;

    const Type& type() const { return type_; }
    std::size_t size() const { return size_; }
    std::byte* bytes() { return block_.data; }
    const std::byte* bytes() const { return block_.data; }

    /// Changes the number of rows. Shrinking keeps the memory.
    void resize(std::size_t rows);
    /// Keeps these rows only, in this order.
    void keep(std::span<const Row> rows);
    /// Removes all rows and their memory.
    void release();

    template <Component C>
    static Type type_of() {
        Type type{typeid(C),
                  C::name,
                  C::unit,
                  C::is_state,
                  C::scalar,
                  C::scalar_size,
                  sizeof(typename C::Value)};
        type.is_carried = C::is_state;
        if constexpr (requires { C::is_carried; }) type.is_carried = C::is_carried;
        if constexpr (requires { C::is_key; }) type.is_key = C::is_key;
        if constexpr (requires { C::is_scratch; }) type.is_scratch = C::is_scratch;
        if constexpr (requires { &C::keep; })
            type.keep = [](const std::byte* value) {
                return C::keep(*reinterpret_cast<const typename C::Value*>(value));
            };
        return type;
    }

private:
    struct Block {
        Block() = default;
        /// `used`: bytes of `bytes` that will be used soon, the first ones.
        Block(std::size_t bytes, std::size_t used);
        Block(Block&& other) noexcept { *this = std::move(other); }
        Block& operator=(Block&& other) noexcept;
        ~Block();
        void* memory = nullptr;
        std::byte* data = nullptr;
        std::size_t mapped = 0; ///< bytes that were mapped, and were zero then; 0: others
    };
    void reserve(std::size_t rows);
    /// Replaces the block by one that holds the values of all rows.
    void use(Block block);

    Type type_;
    Block block_;
    std::size_t size_ = 0;     // rows
    std::size_t capacity_ = 0; // rows
    std::size_t written_ = 0;  // rows of the block that may have been written
};

} // namespace bris

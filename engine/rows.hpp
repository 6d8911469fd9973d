#pragma once

#include "engine/errors.hpp"
#include "engine/world.hpp"

#include <array>
#include <type_traits>

namespace bris {

/// A half-open range of rows.
struct RowRange {
    Row first = 0, last = 0;
    std::size_t size() const { return last - first; }
};

/// View of one table for a system: the columns in its signature (`const`: read, otherwise: written)
/// and the range of rows to work on. Columns are indexed by row over the whole table.
template <Kind K, class... Cs>
class Rows {
public:
    using TableKind = K;

    Rows(std::array<std::byte*, sizeof...(Cs)> columns, std::size_t size, RowRange range)
        : columns_(columns), size_(size), range_(range) {}
    /// The same rows, of a view with more columns or with columns that may be written.
    template <class... Ds>
    requires(!std::is_same_v<Rows<K, Ds...>, Rows>) Rows(const Rows<K, Ds...>& wider)
        : columns_{bytes_of<Cs>(wider.template column<std::remove_const_t<Cs>>())...},
          size_(wider.size()), range_{wider.first(), wider.last()} {}

    /// The same columns, to work on other rows.
    Rows over(RowRange range) const { return {columns_, size_, range}; }

    Row first() const { return range_.first; }
    Row last() const { return range_.last; }
    std::size_t size() const { return size_; } ///< rows of the whole table

    /// The column of component C: `Value*`, or `const Value*` if declared const.
    template <class C>
    auto* column() const {
        constexpr std::size_t i = index<C>();
        using Declared = std::tuple_element_t<i, std::tuple<Cs...>>;
        using Value = std::conditional_t<std::is_const_v<Declared>, const typename C::Value,
                                         typename C::Value>;
        return reinterpret_cast<Value*>(columns_[i]);
    }

private:
    template <class C, class Value>
    static std::byte* bytes_of(Value* column) {
        static_assert(std::is_const_v<C> || !std::is_const_v<Value>);
        return reinterpret_cast<std::byte*>(const_cast<std::remove_const_t<Value>*>(column));
    }
    template <class C>
    static constexpr std::size_t index() {
        constexpr std::array<bool, sizeof...(Cs)> same{
            std::is_same_v<C, std::remove_const_t<Cs>>...};
        for (std::size_t i = 0; i < same.size(); ++i)
            if (same[i]) return i;
        throw "a system may only touch the components in its signature";
    }
    std::array<std::byte*, sizeof...(Cs)> columns_;
    std::size_t size_;
    RowRange range_;
};

} // namespace bris

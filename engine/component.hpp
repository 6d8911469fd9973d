#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace bris {

/// Kind of the numbers of a component, as files show them.
enum class Scalar : std::uint8_t { real, integer };

/// Base of a component that is saved in checkpoints and hashed in fingerprints: a run can be
/// continued from its State alone. The value is plain data made of numbers of one type, `Number`.
template <class T, class Number = std::conditional_t<std::is_arithmetic_v<T>, T, double>>
struct State {
    using Value = T;
    static constexpr bool is_state = true;
    static constexpr Scalar scalar = std::is_integral_v<Number> ? Scalar::integer : Scalar::real;
    static constexpr std::size_t scalar_size = sizeof(Number);
};

/// Base of a component that is recomputed from State and never saved.
template <class T>
struct Derived {
    using Value = T;
    static constexpr bool is_state = false;
    static constexpr Scalar scalar = Scalar::real;
    static constexpr std::size_t scalar_size = 1;
};

/// A column's type: a struct derived from State<T> or Derived<T> with `name` and `unit`. The State
/// column marked `is_key` identifies the rows (unsigned integers, compared in lexicographic order).
/// A State column with `static bool keep(const Value&)` allows rows without content to be left out
/// of files. A Derived column marked `is_carried` is copied with some rows of a table all the same,
/// because its values are learnt from many steps. A Derived column marked `is_scratch` is written
/// anew before it is read, in every step or in every observed one: nobody clears its new rows or
/// moves them when rows are sorted, so that memory that is not written is not used.
template <class C>
concept Component = requires {
    typename C::Value;
    { C::is_state } -> std::convertible_to<bool>;
    C::name;
    C::unit;
};

} // namespace bris

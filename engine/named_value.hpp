#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace bris {

/// A flat key (with the unit as a suffix, as in `confining_pressure_Pa`) and its value: the form in
/// which settings and results are written to summary.json and to the attributes of a run file.
struct NamedValue {
    using Value = std::variant<bool, std::int64_t, std::uint64_t, double, std::string>;

    NamedValue(std::string name, bool x) : key(std::move(name)), value(x) {}
    NamedValue(std::string name, std::signed_integral auto x)
        : key(std::move(name)), value(static_cast<std::int64_t>(x)) {}
    NamedValue(std::string name, std::unsigned_integral auto x)
        : key(std::move(name)), value(static_cast<std::uint64_t>(x)) {}
    NamedValue(std::string name, std::floating_point auto x)
        : key(std::move(name)), value(static_cast<double>(x)) {}
    NamedValue(std::string name, std::string_view x)
        : key(std::move(name)), value(std::string(x)) {}
    NamedValue(std::string name, const std::string& x) : key(std::move(name)), value(x) {}
    NamedValue(std::string name, const char* x) : key(std::move(name)), value(std::string(x)) {}

    /// The value as a flag or a configuration file would give it.
    std::string text() const;

    std::string key;
    Value value;
    std::string flag = {}; ///< of the option that sets it, as --confining-pressure; empty: none
};

} // namespace bris

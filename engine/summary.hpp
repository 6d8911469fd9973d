#pragma once

#include "engine/named_value.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// The results of a run as a flat, ordered list of keys (with units as suffix) and values, which is
/// written as summary.json. What a person sees of it is a Report.
class Summary {
public:
    /// Appends an entry. If the key exists already, its value is replaced in its position.
    void add(const NamedValue& entry);
    template <class T>
    void add(std::string key, const T& value) {
        add(NamedValue(std::move(key), value));
    }
    void add(const std::vector<NamedValue>& entries);

    const std::vector<NamedValue>& entries() const { return entries_; }

    /// One flat JSON object, one line per key. Reading a number back gives the same bits; NaN and
    /// infinity are written as null.
    std::string json() const;

    /// Writes these and the version entries as JSON. The file is replaced completely or not at all.
    /// Throws OutputError.
    void write(const std::filesystem::path& file) const;

private:
    std::vector<NamedValue> entries_;
};

} // namespace bris

#pragma once

#include "engine/named_value.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// The results of a run as a flat, ordered list of keys (units as suffix) and values: a table for
/// the reader at the terminal, and summary.json for programs.
class Summary {
public:
    /// Appends; a key that is there already gets the new value in its old place.
    void add(const NamedValue& entry);
    template <class T>
    void add(std::string key, const T& value) {
        add(NamedValue(std::move(key), value));
    }
    void add(const std::vector<NamedValue>& entries);

    const std::vector<NamedValue>& entries() const { return entries_; }

    /// Two aligned columns, numbers with six significant digits, under a title.
    std::string table(const std::string& title) const;
    /// One flat object, a line per key. Doubles read back to the same bits; NaN and infinity are
    /// null.
    std::string json() const;

    /// Prints the table to stdout. Throws OutputError if stdout does not take it.
    void print(const std::string& title) const;
    /// Replaces the file by the JSON of these and of the version entries, whole or not at all.
    /// Throws OutputError.
    void write(const std::filesystem::path& file) const;

private:
    std::vector<NamedValue> entries_;
};

} // namespace bris

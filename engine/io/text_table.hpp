#pragma once

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// A small table as laboratories and spreadsheets write it: a line of titles, then rows; lines that
/// begin with '#' are comments. Cells are separated by semicolons, tabs or commas, whichever stands
/// in the line of titles first in this order; with semicolons and tabs numbers may have a decimal
/// comma.
struct TextTable {
    /// A column, with the unit in its title: after the last "_", or in brackets at the end.
    struct Column {
        std::string title;
        std::string name; ///< the title without unit, in lower case
        std::string unit; ///< as written; empty: none
        bool
        is_named(std::initializer_list<std::string_view> parts) const; ///< contains one of them
    };

    std::filesystem::path path;
    char delimiter = ',', decimal = '.';
    std::vector<Column> columns;
    std::vector<std::vector<std::string>> rows;
    std::vector<int> lines; ///< of the rows, counted from 1

    /// Index of the only column whose name contains one of `parts` and none of `without`; nothing
    /// if there is none. Throws InputError if there are two.
    std::optional<std::size_t> find(std::initializer_list<std::string_view> parts,
                                    std::initializer_list<std::string_view> without = {}) const;
    /// The same; throws InputError, naming the titles that were found, if there is none. `what`:
    /// for this message.
    std::size_t column(std::string_view what, std::initializer_list<std::string_view> parts,
                       std::initializer_list<std::string_view> without = {}) const;
    /// Number in a cell; NaN if it is empty or "-". Throws InputError with file:line.
    double number(std::size_t row, std::size_t column) const;
    std::string where(std::size_t row) const; ///< file:line
    /// How cells and numbers are separated, for people; empty: by commas and decimal points.
    std::string separators() const;
};

/// Reads such a table. Throws InputError with file:line if there are no titles, if a row has
/// another number of cells, or if there are decimal points and decimal commas; OutputError if the
/// file cannot be read.
TextTable read_text_table(const std::filesystem::path& path);

} // namespace bris

#pragma once

#include "engine/io/csv.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// The text of a logger's file and where in it the table stands, with or without names of columns.
/// Unlike read_csv it takes rows one by one, as text, so that dates and names of sensors can be
/// read and a bad row can be counted.
struct LoggerTable {
    std::filesystem::path path;
    std::string text; ///< as UTF-8
    char delimiter = ',', decimal = '.';
    std::size_t width = 0;                ///< number of columns
    std::vector<std::string> titles;      ///< of all columns; empty: the file does not name them
    std::vector<std::string> units_below; ///< of the line below the names; empty: there is none
    std::vector<std::string> above;       ///< lines above the names or the numbers
    std::size_t names_line = 0, first_line = 1; ///< counted from 1; 0: none

    /// Visits the lines from first_line on that are neither empty nor comments: the number of the
    /// line and its cells, which are `width` unless the line is damaged.
    void each_row(
        const std::function<bool(std::size_t, const std::vector<std::string_view>&)>& take) const;
    /// A cell as a number with the decimal sign of the file; NaN: empty; nothing: not a number.
    std::optional<double> number(std::string_view cell) const;
    /// "name" (column 3), or column 3.
    std::string described(std::size_t column) const;
    /// All columns, for messages.
    std::string columns() const;
};

/// Finds delimiter, decimal sign, names and units from the first lines: those with which most lines
/// are rows of numbers, dates and short names. `form`: of a column map, which then holds. Throws
/// InputError if there is no table; OutputError if the file cannot be read.
LoggerTable find_logger_table(const std::filesystem::path& path, const CsvForm* form = nullptr);

} // namespace bris

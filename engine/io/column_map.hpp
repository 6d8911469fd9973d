#pragma once

#include "engine/io/csv.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// A unit of a column in a foreign file: scale * number + offset is the value in the unit of BRIS.
struct ColumnUnit {
    std::string name;
    double scale = 1, offset = 0;
};

/// A column by its name in BRIS.
struct KnownColumn {
    std::string name;
    std::vector<ColumnUnit> units = {}; ///< empty: a number without a unit
    bool needed = false;
};

/// Reads a column map, which describes the format of a foreign CSV file. It has one entry per line,
/// in any order; "#" begins a comment:
///
///     delimiter = semicolon             one of comma, semicolon, tab, space
///     decimal = comma                   or point
///     comment = %                       character that begins a comment line of the CSV file
///     header_line = 3                   line of the column names; lines before it are skipped
///     first_line = 5                    first line with numbers
///     t  = "Time [ms]", ms              name in BRIS = name in the file, unit in the file
///     ax = -AccY, mg                    another axis with the opposite sign
///
/// A name that contains a comma or "#", begins or ends with a blank, or begins with a minus sign is
/// written in quotes. Throws InputError (file:line, what was expected and what was found) for
/// unknown names, names used twice on either side, unknown units, and missing required columns.
CsvForm read_column_map(const std::filesystem::path& path, const std::vector<KnownColumn>& known);

/// The map that is given or, if none is, the one that stands beside the data, `own`, if it is
/// there.
std::filesystem::path map_to_use(const std::filesystem::path& given,
                                 const std::filesystem::path& own);

/// The names in the file of the columns that are read with this form: those that it requests, or
/// all known ones.
std::vector<std::string> titles_of(const std::vector<KnownColumn>& known, const CsvForm& form);

} // namespace bris

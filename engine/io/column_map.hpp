#pragma once

#include "engine/io/csv.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// A unit in which a column may come: scale * number + offset is in ours.
struct ColumnUnit {
    std::string name;
    double scale = 1, offset = 0;
};

/// A column by the name that this project gives it.
struct KnownColumn {
    std::string name;
    std::vector<ColumnUnit> units = {}; ///< none: a number without
    bool needed = false;
};

/// Reads how a CSV file of someone else is written, a line each, in any order; "#" begins a
/// comment:
///
///     delimiter = semicolon             one of comma, semicolon, tab, space
///     decimal = comma                   or point
///     comment = %                       a sign, with which lines begin that are none of the table
///     header_line = 3                   of the names; what stands before is let be
///     first_line = 5                    of the first numbers
///     t  = "Time [ms]", ms              our name = theirs, its unit
///     ax = -AccY, mg                    of another axis, and of another sign
///
/// Names with a comma, "#", a blank at an end or a minus before them stand in quotes. Throws
/// InputError with file:line, what was expected and what was found: names that nobody knows, of
/// ours or of theirs twice, units that do not fit, columns needed that are missing.
CsvForm read_column_map(const std::filesystem::path& path, const std::vector<KnownColumn>& known);

} // namespace bris

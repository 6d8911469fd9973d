#pragma once

#include "scenarios/records/logger_table.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace bris {

/// A column that the user has given.
struct GivenColumn {
    std::string ours;      ///< t, id, ax ay az, gx gy gz
    std::size_t index = 0; ///< in the table
    double sign = 1;       ///< -1: the axis points the other way
    std::string unit = ""; ///< as column maps spell it; "": not given
};

/// Reads "t=1 ms, ax=2 g, ay=-3, az=ACC01_z [g]": columns by number, counted from 1, or by title,
/// in quotes if it has a comma. Throws InputError for names, columns and units that there are not.
std::vector<GivenColumn> given_columns(const std::string& axes, const LoggerTable& table);

/// Those of a column map that has been read for this table.
std::vector<GivenColumn> given_columns(const CsvForm& form, const LoggerTable& table);

} // namespace bris

#pragma once

#include "scenarios/records/logger_columns.hpp"

#include <string>
#include <vector>

namespace bris {

/// The samples of one sensor as they stand in a file.
struct LoggedRows {
    std::string name;    ///< of the sensor in the column of ids; "": there is none
    unsigned number = 0; ///< in the titles
    bool has_gravity = true, has_force = false, has_rate = false;
    std::size_t axes = 0;              ///< number of axes of the force that were recorded
    std::size_t upwards = 2;           ///< axis along which gravity is added if there is none
    std::vector<double> time, counter; ///< time: s, or NaN; counter: empty if there is none
    std::vector<Vec3> force, rate;     ///< SI units
};

/// Reads all rows, in the order of the sensors' first ones. A row without a number in a column that
/// is used, or with one that no sensor measures, is left out and counted in the notes. Throws
/// InputError, with the line of the first, for more than one such row in twenty.
std::vector<LoggedRows> read_logged_rows(const LoggerTable& table, const LoggerColumns& columns,
                                         std::vector<std::string>& notes);

} // namespace bris

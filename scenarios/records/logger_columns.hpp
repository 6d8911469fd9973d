#pragma once

#include "scenarios/records/logger_file.hpp"
#include "scenarios/records/logger_table.hpp"

#include <array>
#include <cstddef>
#include <optional>

namespace bris {

/// A column of numbers of a logger's table: scale * number is the value in SI units.
struct LoggerColumn {
    std::size_t index = 0;
    double scale = 1;
};

/// The axes of one sensor in the same rows; without a column: not recorded.
struct LoggerAxes {
    unsigned number = 0; ///< in the titles; 0: none
    std::array<std::optional<LoggerColumn>, 3> force = {}, rate = {};
    bool has_gravity = true;

    bool has_force() const { return force[0] || force[1] || force[2]; }
    bool has_rate() const { return rate[0] || rate[1] || rate[2]; }
};

/// How the table gives the times: not at all, as numbers, as a date and time in one column or in
/// two, or as the time of day.
enum class LoggedTime { none, number, date, day_and_time, time_of_day };

/// Which column of a logger's table is which.
struct LoggerColumns {
    LoggedTime form = LoggedTime::none;
    LoggerColumn time;
    std::size_t day = 0;                    ///< column of the date, if it is another one
    bool is_absolute = false;               ///< times are seconds since 1970
    std::optional<std::size_t> counter, id; ///< of samples, and of sensors
    bool id_is_name = false;                ///< a text such as "S1:"
    std::vector<LoggerAxes> sensors;        ///< several only without an id
    double rate = 0;                        ///< Hz, as the user or the file states; 0: none
};

/// The form that a column map gives, of which a logger's file need not have every column. Throws
/// InputError with file:line.
CsvForm form_of_logger(const std::filesystem::path& map);

/// Finds the columns by the user's settings, by titles, and without titles by what they hold; adds
/// to the notes what was assumed and what is ignored. Throws InputError if the axes, the times or
/// the units cannot be told.
LoggerColumns find_logger_columns(const LoggerTable& table, const LoggerSettings& settings,
                                  std::vector<std::string>& notes);

} // namespace bris

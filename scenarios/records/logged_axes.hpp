#pragma once

#include "scenarios/records/given_columns.hpp"
#include "scenarios/records/logger_columns.hpp"
#include "scenarios/records/logger_sample.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// A column that is an axis, with what is stated about it.
struct LoggedAxis {
    std::size_t index = 0;
    double sign = 1;
    std::string unit_word = ""; ///< of the user, the title or the line below; "": not stated
    bool is_of_user = false;    ///< the unit is the user's
};

/// The axes of an accelerometer or of a gyroscope.
struct LoggedVector {
    unsigned number = 0; ///< of the sensor in the titles; 0: none
    bool is_rate = false, is_linear = false, is_bare = false;
    std::array<std::optional<LoggedAxis>, 3> axes = {};
};

/// The vectors that the user gives, the titles name or, without titles, three or six columns of
/// numbers are: for each sensor at most one of forces, with gravity if there is one, and one of
/// rates. Marks their columns as taken. Throws InputError if there is none, or if it cannot be
/// told.
std::vector<LoggedVector> find_logged_vectors(const LoggerTable& table,
                                              const std::vector<SampledColumn>& sample,
                                              const std::vector<GivenColumn>& given,
                                              std::vector<char>& is_taken,
                                              std::vector<std::string>& notes);

} // namespace bris

#pragma once

#include "scenarios/records/logged_rows.hpp"

#include <string>
#include <vector>

namespace bris {

/// Puts the times of a sensor's rows in order, and returns its sampling rate, Hz. Without times
/// they are counted at the stated rate, by the counter if there is one. Rows whose time goes back
/// or repeats are left out; if more than one in ten repeats, because the clock is coarse or a
/// packet of samples has one time, they are spread evenly. The stated rate holds within 2 %. `file`
/// and `sensor` are for messages. Throws InputError if there is neither time nor rate, if more than
/// one time in twenty goes back, or if the times contradict the rate that the user gives.
double order_times(LoggedRows& rows, const LoggerColumns& columns, bool is_rate_of_user,
                   const std::string& file, const std::string& sensor,
                   std::vector<std::string>& notes);

} // namespace bris

#pragma once

#include <string>
#include <vector>

namespace bris {

/// The sampling rate, Hz, that lines above a table state, such as "data_rate = 2000.0 Hz" or
/// "Update Rate: 100.0Hz"; 0: none, or several different ones.
double rate_stated_in(const std::vector<std::string>& lines);

} // namespace bris

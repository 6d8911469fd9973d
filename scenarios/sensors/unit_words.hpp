#pragma once

#include "engine/io/column_map.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// The one of `units` that a word means: "m/s^2" is m/s2, "\u00b0/s" and "dps" are deg/s, "seconds"
/// is s. A word that is not known, or means none of them, gives "".
std::string unit_named(std::string_view word, const std::vector<ColumnUnit>& units);

/// Whether a word means any unit at all.
bool is_unit(std::string_view word);

} // namespace bris

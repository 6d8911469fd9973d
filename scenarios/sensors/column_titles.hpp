#pragma once

#include "engine/io/column_map.hpp"

#include <optional>
#include <string>

namespace bris {

/// The title of a column as other programs write it, "Gyro X [deg/s]", as one of BRIS.
struct TitleMatch {
    std::optional<std::string> unit_word; ///< that the title states; none: it states no unit
};

/// Whether a title is a usual one of this column of BRIS, and which unit it states: "Acc X (g)",
/// "acc_x_mg", "X-Axis gyro", "seconds". Nothing: it is not.
std::optional<TitleMatch> match_title(const std::string& title, const KnownColumn& column);

} // namespace bris

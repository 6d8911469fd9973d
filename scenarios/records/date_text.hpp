#pragma once

#include <optional>
#include <string_view>

namespace bris {

/// A date, a time of day, or both, as loggers write them.
struct DateText {
    double seconds = 0; ///< since 1970 if there is a date, otherwise since midnight
    bool has_date = false, has_time = false;
    bool has_zone = false; ///< Z, or an offset from UTC, which is taken into account
};

/// "2022-11-04 08:36:24.897", "2022-11-04T08:36:24Z", "2022/11/04", "04.11.2022 08:36:24,897",
/// "08:36:24.897", with "Z", "UTC" or an offset such as "+01:00" after it. 04/11/2022 is not read:
/// which number is the month differs from land to land.
std::optional<DateText> date_in(std::string_view text);

} // namespace bris

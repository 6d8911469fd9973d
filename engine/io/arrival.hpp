#pragma once

#include <limits>

namespace bris {

/// Time of arrival (s since 1970 UTC) on a clock that only goes forward, also while the computer
/// sleeps: CLOCK_BOOTTIME, after one look at the wall clock at the first call of this program. What
/// becomes of the wall clock later changes nothing.
double arrival_now();
/// What this program adds to the time since the computer was started (CLOCK_BOOTTIME, s) to get a
/// time of arrival.
double arrival_anchor();

/// What did not arrive while somebody listened, such as the lines of a file, has no such time.
inline constexpr double no_arrival = std::numeric_limits<double>::quiet_NaN();

} // namespace bris

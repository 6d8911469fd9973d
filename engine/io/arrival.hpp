#pragma once

#include <limits>
#include <string>

namespace bris {

/// Time of arrival (s since 1970 UTC) on a clock that only goes forward, also while the computer
/// sleeps: CLOCK_BOOTTIME, after one look at the wall clock at the first call of this program. What
/// becomes of the wall clock later changes nothing.
double arrival_now();
/// What this program adds to the time since the computer was started (CLOCK_BOOTTIME, s) to get a
/// time of arrival.
double arrival_anchor();
/// Which run of the computer the time since its start belongs to; empty: unknown.
std::string boot_of_computer();

/// Where the arrivals of an earlier program ended.
struct ArrivalsBefore {
    double anchor = std::numeric_limits<double>::quiet_NaN(); ///< s
    double last = std::numeric_limits<double>::quiet_NaN();   ///< s
    std::string boot = {};
};
/// The anchor with which the arrivals of `before` go on, at `since_boot` (s) after the start `boot`
/// of the computer, where the wall clock says `anchor`: that of before, whatever became of the wall
/// clock, while the computer has been on; else that of the wall clock, but nothing arrives earlier
/// than what has arrived.
double anchor_after(const ArrivalsBefore& before, const std::string& boot, double since_boot,
                    double anchor);
/// Goes on with the arrivals of an earlier program, in place of a look at the wall clock.
void go_on_after(const ArrivalsBefore& before);

/// What did not arrive while somebody listened, such as the lines of a file, has no such time.
inline constexpr double no_arrival = std::numeric_limits<double>::quiet_NaN();

} // namespace bris

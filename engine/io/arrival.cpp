#include "engine/io/arrival.hpp"

#include <ctime>

namespace bris {

namespace {

double seconds_of(clockid_t clock) {
    timespec now{};
    clock_gettime(clock, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

} // namespace

double arrival_anchor() {
    static const double anchor = seconds_of(CLOCK_REALTIME) - seconds_of(CLOCK_BOOTTIME);
    return anchor;
}

double arrival_now() { return arrival_anchor() + seconds_of(CLOCK_BOOTTIME); }

} // namespace bris

#include "engine/io/arrival.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <ctime>
#include <fstream>

namespace bris {

namespace {

double seconds_of(clockid_t clock) {
    timespec now{};
    clock_gettime(clock, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double anchor_of_wall_clock() { return seconds_of(CLOCK_REALTIME) - seconds_of(CLOCK_BOOTTIME); }

std::atomic<double>& anchor() {
    static std::atomic<double> value = anchor_of_wall_clock();
    return value;
}

} // namespace

double arrival_anchor() { return anchor(); }

double arrival_now() { return arrival_anchor() + seconds_of(CLOCK_BOOTTIME); }

std::string boot_of_computer() {
    std::ifstream in("/proc/sys/kernel/random/boot_id");
    std::string id;
    std::getline(in, id);
    return id;
}

double anchor_after(const ArrivalsBefore& before, const std::string& boot, double since_boot,
                    double anchor) {
    if (!boot.empty() && boot == before.boot && std::isfinite(before.anchor)) return before.anchor;
    return std::isfinite(before.last) ? std::max(anchor, before.last - since_boot) : anchor;
}

void go_on_after(const ArrivalsBefore& before) {
    anchor() = anchor_after(before, boot_of_computer(), seconds_of(CLOCK_BOOTTIME),
                            anchor_of_wall_clock());
}

} // namespace bris

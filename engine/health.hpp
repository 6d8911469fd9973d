#pragma once

#include <string>

namespace bris {

/// Result of the guard's checks. The simulation stops when `bad` is set.
struct Health {
    static constexpr auto name = "health";
    static constexpr bool is_state = true;
    bool bad = false;
    std::string what; ///< the reason in one line, without step and time
};

} // namespace bris

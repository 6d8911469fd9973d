#pragma once

#include <string>

namespace bris {

/// What the guard has seen.
struct Health {
    static constexpr auto name = "health";
    static constexpr bool is_state = true;
    bool bad = false;
    std::string what; ///< one line, without step and time
};

} // namespace bris

#pragma once

#include <atomic>
#include <string>

namespace bris {

/// Result of the guard's checks. The simulation stops when `bad` is set.
struct Health {
    static constexpr auto name = "health";
    static constexpr bool is_state = true;
    bool bad = false;
    std::string what; ///< the reason in one line, without step and time
};

/// Set in a step in which a guard has to look more closely.
struct Alarm {
    static constexpr auto name = "alarm";
    static constexpr bool is_state = true; // so that nobody leaves out the systems that raise it
    static constexpr bool writers_commute = true;
    bool raised = false;

    /// May be called by several threads.
    void raise() { std::atomic_ref(raised).store(true, std::memory_order_relaxed); }
};

} // namespace bris

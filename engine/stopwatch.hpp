#pragma once

#include <chrono>

namespace bris {

using Instant = std::chrono::steady_clock::time_point;
inline Instant this_instant() { return std::chrono::steady_clock::now(); }
/// Wall time (s) since `began`.
inline double seconds_since(Instant began) {
    return std::chrono::duration<double>(this_instant() - began).count();
}

} // namespace bris

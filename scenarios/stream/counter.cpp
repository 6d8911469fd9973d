#include "scenarios/stream/counter.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr std::int64_t longest_gap = 1 << 20; // samples that may be missing in a row

} // namespace

std::int64_t Counter::take(std::uint64_t raw, double elapsed) {
    const auto count = static_cast<std::int64_t>(raw);
    const std::int64_t direct = count + base_, ahead = direct - latest_;
    const auto due = static_cast<std::int64_t>(std::llround(elapsed * rate_));
    largest_ = std::max(largest_, raw);
    const auto follow = [&](std::int64_t unwrapped) {
        base_ = unwrapped - count;
        return latest_ = unwrapped;
    };
    if (!begun_) {
        begun_ = true;
        return follow(direct);
    }
    if (restarted_) {
        restarted_ = false;
        ++restarts_;
        return follow(latest_ + std::max<std::int64_t>(1, due));
    }
    if (elapsed > 0 && ahead > 0 && ahead <= longest_gap) return follow(direct);
    if (elapsed <= 0 && ahead <= 0 && ahead >= -longest_gap) return direct; // it comes late
    // beyond half a period, time cannot tell the number of wraps
    for (const int bits : {8, 16, 24, 32}) {
        const std::int64_t period = std::int64_t{1} << bits;
        if (largest_ >= static_cast<std::uint64_t>(period)) continue;
        const double turns =
            static_cast<double>(latest_ + due - direct) / static_cast<double>(period);
        const std::int64_t unwrapped = direct + std::llround(turns) * period;
        const std::int64_t off = std::abs(unwrapped - latest_ - due);
        if (off > period / 4 || (elapsed > 0) != (unwrapped > latest_)) continue;
        if (elapsed <= 0) return unwrapped;
        ++wraps_;
        return follow(unwrapped);
    }
    if (elapsed <= 0) return latest_ + due;
    ++restarts_;
    return follow(latest_ + std::max<std::int64_t>(1, due));
}

} // namespace bris

#pragma once

#include <cstdint>

namespace bris {

/// Sample counts of one source, unwrapped: what its records carry may have 8, 16, 24 or 32 bits, or
/// begin again when the source restarts; what comes out only goes forward with the source's time.
class Counter {
public:
    /// `rate`: samples per second that the source is said to take.
    explicit Counter(double rate) : rate_(rate) {}
    /// The unwrapped count of a record. `elapsed`: s from the latest record before to this one by
    /// the source's unwrapped clock; negative for a record that comes late.
    std::int64_t take(std::uint64_t raw, double elapsed);
    /// After this the next record may have any count, as when the clock began again.
    void restart() { restarted_ = begun_; }
    std::uint64_t wraps() const { return wraps_; }
    std::uint64_t restarts() const { return restarts_; }

private:
    double rate_;
    bool begun_ = false, restarted_ = false;
    std::int64_t base_ = 0;     // unwrapped less raw
    std::int64_t latest_ = 0;   // unwrapped
    std::uint64_t largest_ = 0; // raw, so far
    std::uint64_t wraps_ = 0, restarts_ = 0;
};

} // namespace bris

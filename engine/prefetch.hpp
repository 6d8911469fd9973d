#pragma once

namespace bris {

/// Requests the cache line of an address that will soon be read, or written with `for_writing`. The
/// address need not be valid. g++ treats functions that contain only __builtin_prefetch as free of
/// side effects and drops calls to them; the empty asm statement prevents that.
template <bool for_writing = false>
inline void prefetch(const void* address) {
    __builtin_prefetch(address, for_writing ? 1 : 0);
    asm volatile("");
}

} // namespace bris

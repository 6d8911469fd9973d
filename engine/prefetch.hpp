#pragma once

namespace bris {

/// Asks for the cache line of an address that will be read soon, or `for_writing`; any address,
/// valid or not. g++ takes functions that do nothing but __builtin_prefetch for free of effects and
/// leaves calls of them out; the empty statement keeps them.
template <bool for_writing = false>
inline void prefetch(const void* address) {
    __builtin_prefetch(address, for_writing ? 1 : 0);
    asm volatile("");
}

} // namespace bris

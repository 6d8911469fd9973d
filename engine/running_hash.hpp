#pragma once

#include <cstdint>

namespace bris {

/// A hash `h` of words, and one more: MurmurHash3's 64-bit finaliser as the mixing step. Every bit
/// of the word reaches every bit of the hash.
inline std::uint64_t mix(std::uint64_t h, std::uint64_t word) {
    h ^= word;
    h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdu;
    h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53u;
    return h ^ (h >> 33);
}

} // namespace bris

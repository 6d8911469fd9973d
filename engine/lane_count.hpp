#pragma once

// Whoever includes a World has to be compiled with the flags that its library was compiled with, or
// rows, sums and bits would differ without an error: wrong definitions do not compile, and another
// number of lanes does not link, because it is part of the name of World.

#if !defined EIGEN_DONT_VECTORIZE || !defined EIGEN_DONT_PARALLELIZE || defined __FAST_MATH__
#error "expected the compile flags of bris::engine; link that target, or pass its flags yourself"
#endif

#ifdef __AVX512F__
#define BRIS_LANES lanes_8
#else
#define BRIS_LANES lanes_4
#endif

namespace bris {

inline namespace BRIS_LANES {
/// Contacts or bodies that are computed at a time.
#ifdef __AVX512F__
inline constexpr int lane_count = 8;
#else
inline constexpr int lane_count = 4;
#endif
} // namespace BRIS_LANES

} // namespace bris

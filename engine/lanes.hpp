#pragma once

#include "engine/lane_count.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#ifdef __SSE2__
#include <immintrin.h>
#endif

namespace bris {

inline namespace BRIS_LANES {

// SIMD vectors by the compiler's vector extension: one source for SSE2, AVX2, AVX-512 and Arm. Only
// IEEE operations are used and none is fused, so every instruction set gives the same bits in every
// lane.

/// One number for each of `lane_count` contacts or bodies.
using Lane [[gnu::vector_size(sizeof(double) * lane_count)]] = double;
/// All bits of a lane are set or none; the result of comparing two Lanes.
using LaneMask [[gnu::vector_size(sizeof(double) * lane_count)]] = std::int64_t;
/// Half a cache line: x, y, z and one more number.
using Quad [[gnu::vector_size(4 * sizeof(double)), gnu::may_alias]] = double;
/// Integers that are added modulo 2^64, as the bits of signed ones are.
using BitsOfLane [[gnu::vector_size(sizeof(double) * lane_count)]] = std::uint64_t;
using BitsOfQuad [[gnu::vector_size(4 * sizeof(double)), gnu::may_alias]] = std::uint64_t;

inline Lane lanes(double value) { return value - Lane{}; }

inline Lane sqrt(Lane a) {
#ifdef __AVX512F__
    return _mm512_maskz_sqrt_pd(0xff, a); // the unmasked form trips g++ 12's uninitialised warning
#elif defined __AVX__
    return _mm256_sqrt_pd(a);
#elif defined __SSE2__
    const auto low = _mm_sqrt_pd(__builtin_shufflevector(a, a, 0, 1)),
               high = _mm_sqrt_pd(__builtin_shufflevector(a, a, 2, 3));
    return __builtin_shufflevector(low, high, 0, 1, 2, 3);
#else
    for (int k = 0; k < lane_count; ++k) a[k] = std::sqrt(a[k]);
    return a;
#endif
}
/// Nearest integers; halves are rounded to even. Numbers beyond 2^62 and NaN give no valid result.
inline LaneMask nearest_integers(Lane a) {
#ifdef __AVX512DQ__
    return reinterpret_cast<LaneMask>(_mm512_maskz_cvtpd_epi64(0xff, a));
#else
    // A number near 1.5 * 2^52 has its integer part in its low bits: first that of the multiples of
    // 2^32, then that of the remainder, which is exact.
    constexpr double shift = 0x1.8p52;
    constexpr auto shift_bits = std::bit_cast<std::uint64_t>(shift);
    const Lane high = a * 0x1p-32 + shift, low = a - (high - shift) * 0x1p32 + shift;
    return reinterpret_cast<LaneMask>((reinterpret_cast<BitsOfLane>(high) << 32) +
                                      reinterpret_cast<BitsOfLane>(low) - (shift_bits << 32) -
                                      shift_bits);
#endif
}
inline Lane magnitude(Lane a) {
    return reinterpret_cast<Lane>(reinterpret_cast<LaneMask>(a) &
                                  std::numeric_limits<std::int64_t>::max());
}
inline Lane floor(Lane a) {
#ifdef __AVX512F__
    return _mm512_maskz_roundscale_pd(0xff, a, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
#elif defined __AVX__
    return _mm256_floor_pd(a);
#else
    for (int k = 0; k < lane_count; ++k) a[k] = std::floor(a[k]);
    return a;
#endif
}
/// 1 / sqrt(a) from an initial guess g: two Newton steps leave 3.4 times the fourth power of the
/// relative error of g.
inline Lane inverse_root(Lane a, Lane g) {
    const Lane better = g * (1.5 - 0.5 * a * g * g);
    return better * (1.5 - 0.5 * a * better * better);
}
inline Lane min(Lane a, Lane b) { return a < b ? a : b; }
inline Lane max(Lane a, Lane b) { return a > b ? a : b; }

/// One bit per lane: bit k is set if lane k of the mask is set.
inline unsigned bits(LaneMask mask) {
#if defined __AVX512DQ__
    return _mm512_movepi64_mask(reinterpret_cast<__m512i>(mask));
#elif defined __AVX__ && !defined __AVX512F__
    return static_cast<unsigned>(_mm256_movemask_pd(reinterpret_cast<__m256d>(mask)));
#else
    unsigned all = 0;
    for (int k = 0; k < lane_count; ++k) all |= (mask[k] != 0 ? 1u : 0u) << k;
    return all;
#endif
}

/// Bits of a mask that is set in every lane.
inline constexpr unsigned all_lanes = (1u << lane_count) - 1;

/// Loads lane_count consecutive numbers. The address may have any alignment, here and in all
/// functions below.
inline Lane load_lane(const double* numbers) {
    Lane a;
    std::memcpy(&a, numbers, sizeof a);
    return a;
}
inline void store_lane(double* numbers, Lane a) { std::memcpy(numbers, &a, sizeof a); }

/// Mask of the lanes in which the number is `value`.
inline LaneMask equal_lanes(const std::uint32_t* numbers, std::uint32_t value) {
    using Numbers [[gnu::vector_size(sizeof(std::uint32_t) * lane_count)]] = std::uint32_t;
    Numbers all;
    std::memcpy(&all, numbers, sizeof all);
    return __builtin_convertvector(all == value, LaneMask);
}

inline Quad load(const double* row) {
    Quad a;
    std::memcpy(&a, row, sizeof a);
    return a;
}
inline void store(double* row, Quad value) { std::memcpy(row, &value, sizeof value); }
/// Rows of four numbers, one row per lane, as four Lanes, and the reverse (by the same shuffles).
using FourLanes = std::array<Lane, 4>;

namespace shuffles {

#ifdef __AVX512F__
inline Lane join(Quad a, Quad b) { return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7); }
inline Lane even(Lane a, Lane b) {
    return __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
}
inline Lane odd(Lane a, Lane b) { return __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15); }
inline Lane low(Lane a, Lane b) { return __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13); }
inline Lane high(Lane a, Lane b) {
    return __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
}
#else
inline Lane even(Lane a, Lane b) { return __builtin_shufflevector(a, b, 0, 4, 2, 6); }
inline Lane odd(Lane a, Lane b) { return __builtin_shufflevector(a, b, 1, 5, 3, 7); }
inline Lane low(Lane a, Lane b) { return __builtin_shufflevector(a, b, 0, 1, 4, 5); }
inline Lane high(Lane a, Lane b) { return __builtin_shufflevector(a, b, 2, 3, 6, 7); }
#endif

} // namespace shuffles

/// Loads row_of(q) into entry q; with 8 lanes, rows q and q + 4 side by side.
template <class RowOf>
FourLanes load_rows(RowOf&& row_of) {
    FourLanes rows;
    for (int q = 0; q < 4; ++q) {
#ifdef __AVX512F__
        rows[static_cast<std::size_t>(q)] = shuffles::join(load(row_of(q)), load(row_of(q + 4)));
#else
        rows[static_cast<std::size_t>(q)] = load(row_of(q));
#endif
    }
    return rows;
}

/// The same four numbers for each of the rows that load_rows places side by side.
inline Lane in_each_row(Quad a) {
#ifdef __AVX512F__
    return shuffles::join(a, a);
#else
    return a;
#endif
}

/// The fourth number of each row, in all four places of the row.
inline Lane fourth_of_each_row(Lane row) {
#ifdef __AVX512F__
    return __builtin_shufflevector(row, row, 3, 3, 3, 3, 7, 7, 7, 7);
#else
    return __builtin_shufflevector(row, row, 3, 3, 3, 3);
#endif
}

/// 4x4 transposes within the lanes: from rows to columns and from columns to rows.
inline FourLanes transpose(const FourLanes& r) {
    using namespace shuffles;
    const Lane a = even(r[0], r[1]), b = odd(r[0], r[1]), c = even(r[2], r[3]), d = odd(r[2], r[3]);
    return {low(a, c), low(b, d), high(a, c), high(b, d)};
}

/// Sums of the four numbers of each row.
inline Lane row_sums(const FourLanes& r) {
    using namespace shuffles;
    const Lane a = even(r[0], r[1]) + odd(r[0], r[1]), b = even(r[2], r[3]) + odd(r[2], r[3]);
    return low(a, b) + high(a, b);
}

/// Writes row q of `rows` (in the layout of load_rows) to row_of(q), for the first `count` lanes.
template <class RowOf>
void store_rows(const FourLanes& rows, int count, RowOf&& row_of) {
    for (int q = 0; q < 4; ++q) {
        const Lane r = rows[static_cast<std::size_t>(q)];
#ifdef __AVX512F__
        if (q < count) store(row_of(q), __builtin_shufflevector(r, r, 0, 1, 2, 3));
        if (q + 4 < count) store(row_of(q + 4), __builtin_shufflevector(r, r, 4, 5, 6, 7));
#else
        if (q < count) store(row_of(q), r);
#endif
    }
}

/// Adds (or subtracts) row q of `first` to the four int64 numbers at row_of(q) and row q of
/// `second` to the four after them, for the first `count` lanes in order, so that lanes may share a
/// row. `first`, `second`: bits of int64 numbers in the layout of load_rows. Sums beyond 2^63 wrap:
/// who adds such numbers has to notice it.
template <bool subtracts, class RowOf>
[[gnu::always_inline]] inline void add_integer_rows(const FourLanes& first, const FourLanes& second,
                                                    int count, RowOf&& row_of) {
    const auto add = [](std::int64_t * row, auto more) __attribute__((always_inline)) {
        decltype(more) sum;
        std::memcpy(&sum, row, sizeof sum);
        sum = subtracts ? sum - more : sum + more;
        std::memcpy(row, &sum, sizeof sum);
    };
    // lanes 0 to 3 lie in the lower halves of the rows, lanes 4 to 7 in the upper halves
    const auto add_all = [&](int lanes_used) __attribute__((always_inline)) {
        for (int q = 0; q < 4; ++q) {
            const auto k = static_cast<std::size_t>(q);
#ifdef __AVX512F__
            if (q < lanes_used)
                add(row_of(q), reinterpret_cast<BitsOfLane>(__builtin_shufflevector(
                                   first[k], second[k], 0, 1, 2, 3, 8, 9, 10, 11)));
            if (q + 4 < lanes_used)
                add(row_of(q + 4), reinterpret_cast<BitsOfLane>(__builtin_shufflevector(
                                       first[k], second[k], 4, 5, 6, 7, 12, 13, 14, 15)));
#else
            if (q >= lanes_used) return;
            add(row_of(q), reinterpret_cast<BitsOfQuad>(first[k]));
            add(row_of(q) + 4, reinterpret_cast<BitsOfQuad>(second[k]));
#endif
        }
    };
    if (count == lane_count)
        add_all(lane_count); // without branches
    else
        add_all(count);
}

/// Consecutive vectors of three numbers, one vector per lane, as x, y and z, and the reverse.
using ThreeLanes = std::array<Lane, 3>;

inline ThreeLanes load_triples(const double* rows) {
    const Lane a = load_lane(rows), b = load_lane(rows + lane_count),
               c = load_lane(rows + 2 * lane_count);
#ifdef __AVX512F__
    const Lane x = __builtin_shufflevector(a, b, 0, 3, 6, 9, 12, 15, -1, -1);
    const Lane y = __builtin_shufflevector(a, b, 1, 4, 7, 10, 13, -1, -1, -1);
    const Lane z = __builtin_shufflevector(a, b, 2, 5, 8, 11, 14, -1, -1, -1);
    return {__builtin_shufflevector(x, c, 0, 1, 2, 3, 4, 5, 10, 13),
            __builtin_shufflevector(y, c, 0, 1, 2, 3, 4, 8, 11, 14),
            __builtin_shufflevector(z, c, 0, 1, 2, 3, 4, 9, 12, 15)};
#else
    const Lane x = __builtin_shufflevector(a, b, 0, 3, 6, -1);
    const Lane y = __builtin_shufflevector(a, b, 1, 4, 7, -1);
    const Lane z = __builtin_shufflevector(a, b, 2, 5, -1, -1);
    return {__builtin_shufflevector(x, c, 0, 1, 2, 5), __builtin_shufflevector(y, c, 0, 1, 2, 6),
            __builtin_shufflevector(z, c, 0, 1, 4, 7)};
#endif
}

inline void store_triples(double* rows, const ThreeLanes& v) {
    const auto& [x, y, z] = v;
#ifdef __AVX512F__
    const Lane a = __builtin_shufflevector(x, y, 0, 8, -1, 1, 9, -1, 2, 10);
    const Lane b = __builtin_shufflevector(x, y, -1, 3, 11, -1, 4, 12, -1, 5);
    const Lane c = __builtin_shufflevector(x, y, 13, -1, 6, 14, -1, 7, 15, -1);
    store_lane(rows, __builtin_shufflevector(a, z, 0, 1, 8, 3, 4, 9, 6, 7));
    store_lane(rows + lane_count, __builtin_shufflevector(b, z, 10, 1, 2, 11, 4, 5, 12, 7));
    store_lane(rows + 2 * lane_count, __builtin_shufflevector(c, z, 0, 13, 2, 3, 14, 5, 6, 15));
#else
    const Lane a = __builtin_shufflevector(x, y, 0, 4, -1, 1);
    const Lane b = __builtin_shufflevector(x, y, 5, -1, 2, 6);
    const Lane c = __builtin_shufflevector(x, y, -1, 3, 7, -1);
    store_lane(rows, __builtin_shufflevector(a, z, 0, 1, 4, 3));
    store_lane(rows + lane_count, __builtin_shufflevector(b, z, 0, 5, 2, 3));
    store_lane(rows + 2 * lane_count, __builtin_shufflevector(c, z, 6, 1, 2, 7));
#endif
}

} // namespace BRIS_LANES

} // namespace bris

#pragma once

#include "engine/parallel.hpp"
#include "systems/contact/tile.hpp"

#include <algorithm>

namespace bris::detail {

/// Number of near rows whose bodies, springs and sums fill a cache of some ten megabytes: of single
/// spheres, and of clumps, whose springs lie among those of more candidates. With at most so many
/// rows, prefetching costs more than it brings.
inline constexpr std::size_t near_spheres_in_cache = 65536, near_rows_of_clumps_in_cache = 20000;

/// Near rows whose touching pairs are listed before the law is applied to them.
inline constexpr std::size_t near_rows_per_block = 2048;

/// Those of the near pairs that are apart (bits) on which the law acts beyond touch.
template <class Law, class Geometry>
unsigned held(const TileTarget& to, const Geometry& geometry, Row first, unsigned apart) {
    unsigned found = 0;
    for (; apart != 0; apart &= apart - 1) {
        const auto q = static_cast<Row>(__builtin_ctz(apart));
        const NearEntry& near = to.near[first + q];
        if (is_held<Law>(to, near, geometry.gap(near), geometry.radius(near))) found |= 1u << q;
    }
    return found;
}

/// Those of the near pairs that are apart (bits) that touched in the last step, as their springs
/// record.
inline unsigned ended(const TileTarget& to, Row first, unsigned apart) {
    unsigned found = 0;
    for (; apart != 0; apart &= apart - 1) {
        const auto q = static_cast<Row>(__builtin_ctz(apart));
        if (Spring::keep(to.history.spring[to.near[first + q].pair])) found |= 1u << q;
    }
    return found;
}

/// The same where the law does not clear their springs.
inline unsigned separate(const TileTarget& to, Row first, unsigned apart, Separated& separated) {
    const unsigned found = ended(to, first, apart);
    for (unsigned left = found; left != 0; left &= left - 1)
        separated.add(to.near[first + static_cast<Row>(__builtin_ctz(left))].pair);
    return found;
}

/// Writes row + q for each set bit q of `which`, a byte, to list[count] and after, and returns the
/// new count. Without branches, since bits of pairs that touch cannot be predicted; up to 8 entries
/// of the list after the last one are overwritten.
inline std::size_t append_rows(Row* list, std::size_t count, Row row, unsigned which) {
#ifdef __AVX512VL__
    const __m256i rows = _mm256_add_epi32(_mm256_set1_epi32(static_cast<int>(row)),
                                          _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(list + count),
                        _mm256_maskz_compress_epi32(static_cast<__mmask8>(which), rows));
    return count + static_cast<std::size_t>(__builtin_popcount(which));
#else
    for (Row q = 0; q < 8; ++q) {
        list[count] = row + q;
        count += (which >> q) & 1;
    }
    return count;
#endif
}

/// Lists the touching pairs of near rows [first, last) that have to be evaluated, and those whose
/// contact has just ended, or clears the springs of the latter. `flags`: of the first row. Returns
/// their number.
template <class Law, class Geometry>
std::size_t list_touching(const TileTarget& to, const Geometry& geometry, Sleepers& sleepers,
                          Separated& separated, std::uint8_t* flags, std::size_t first_group,
                          Row first, Row last, Row* touching) {
    std::size_t count = 0;
    for (Row row = first; row < last; row += 8) {
        const std::size_t group = first_group + (row - first) / 8;
        if (sleepers.skips(group)) continue;
        unsigned now = geometry.touching(to.near + row);
        if constexpr (lane_count == 4) now |= geometry.touching(to.near + row + 4) << 4;
        const unsigned here = last - row < 8 ? (1u << (last - row)) - 1 : 0xff;
        now &= here; // springs of the next chunk may be written meanwhile
        if constexpr (Law::has_reach) now |= held<Law>(to, geometry, row, here & ~now);
        if (row + 56 <= last) geometry.prefetch_positions(to.near + row + 48);
        now = sleepers.touching(group, now, flags[group]);
        const unsigned apart = flags[group] & ~now;
        flags[group] = static_cast<std::uint8_t>(now);
        now = sleepers.asked(group, row, now);
        if constexpr (Law::corrects_end && !Law::has_reach) {
            const unsigned just_ended = ended(to, row, apart); // the law clears their springs
            if constexpr (Law::has_wear) forget(to, row, apart & ~just_ended);
            now |= just_ended;
        } else if (apart != 0 && Law::has_history && !Law::has_reach && to.work.friction != nullptr)
            now |= separate(to, row, apart, separated);
        else
            forget(to, row, apart);
        count = append_rows(touching, count, row, now);
    }
    return count;
}

/// Computes the forces of a chunk of near rows: lists the rows that touch, then applies the law to
/// lane_count of them at a time. A Geometry describes the surfaces:
///   unsigned touching(near)         bit q: near pair q of lane_count touches
///   double gap(near), radius(near)  of one pair: gap between the surfaces, effective radius, m
///   void prefetch_positions(near)   prefetches what touching() will read for these eight pairs
///   void prefetch_rows<where>(to, rows)   prefetches what the tile after the next will read
///   void prefetch_partner(to, row)  of spheres: prefetches what a pair reads and writes of its
///                                   partner
///   unsigned collide<Law, where>(to, rows, count)   applies the law (`where`: SumsAt); bits of the
///                                   lanes whose overlap or force is beyond the limit
template <class Law, class Geometry, class Pairs>
void collide_chunk(const TileTarget& to, const Geometry& geometry, NearIndex<Pairs>& index,
                   std::size_t chunk) {
    const NearChunk& here = index.chunks[chunk];
    alignas(64) std::array<Row, near_rows_per_block + 8> touching;
    const auto flags_of = [&](std::vector<std::uint8_t>& flags) {
        return flags.empty() ? nullptr : flags.data() + here.first_flags;
    };
    Sleepers sleepers(to, flags_of(index.awake), flags_of(index.look));
    Separated separated;
    const bool far =
        index.size() > (index.centred ? near_spheres_in_cache : near_rows_of_clumps_in_cache);
    constexpr bool of_spheres = std::is_same_v<Pairs, SpherePairs>;
    if constexpr (of_spheres)
        if (!far) // other threads have written these rows
            for (std::size_t k = here.first_across; k < here.last_across; ++k)
                geometry.prefetch_partner(to, index.across[k]);
    const auto collide = [&]<SumsAt where>(std::size_t count) {
        if (count != 0) std::fill_n(&touching[count], 8, touching[count - 1]);
        for (std::size_t k = 0; k < count; k += lane_count) {
            if (far && k + 3 * lane_count <= count)
                geometry.template prefetch_rows<where>(to, &touching[k + 2 * lane_count]);
            const int here_count = static_cast<int>(std::min<std::size_t>(lane_count, count - k));
            const unsigned beyond =
                geometry.template collide<Law, where>(to, &touching[k], here_count);
            if (beyond != 0 && index.beyond_limit[chunk] == no_row)
                index.beyond_limit[chunk] =
                    touching[k + static_cast<std::size_t>(__builtin_ctz(beyond))];
        }
    };
    std::size_t across = here.first_across;
    for (Row first = here.first; first < here.last; first += near_rows_per_block) {
        const Row last = std::min<Row>(first + near_rows_per_block, here.last);
        const std::size_t count =
            list_touching<Law>(to, geometry, sleepers, separated, flags_of(index.touching),
                               (first - here.first) / 8, first, last, touching.data());
        const std::size_t across_before = across;
        while (across < here.last_across && index.across[across] < last) ++across;
        if constexpr (of_spheres) {
            if (across == across_before)
                collide.template operator()<SumsAt::bodies>(count);
            else
                collide.template operator()<SumsAt::rows>(count);
        } else {
            collide.template operator()<SumsAt::rows>(count);
        }
        separated.clear_springs(to);
        sleepers.put_springs_back();
    }
}

/// The same for all near rows of a kind of pair, in parallel.
template <class Law, class Geometry, class Pairs>
void collide_all(const TileTarget& to, const Geometry& geometry, NearIndex<Pairs>& index) {
    for_chunks(index.chunks.size(), 1, [&](std::size_t chunk, std::size_t, std::size_t) {
        collide_chunk<Law>(to, geometry, index, chunk);
    });
}

} // namespace bris::detail

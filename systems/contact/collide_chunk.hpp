#pragma once

#include "engine/parallel.hpp"
#include "systems/contact/tile.hpp"

#include <algorithm>

namespace bris::detail {

/// Number of near rows whose bodies, springs and records fill a cache of one megabyte. With at most
/// so many rows, prefetching is not needed.
inline constexpr std::size_t near_rows_in_cache = 8192;

/// Those of a group of eight near pairs that do not touch, but on which the law acts beyond touch,
/// as bits.
template <class Law, class Geometry>
unsigned held(const TileTarget& to, const Geometry& geometry, std::size_t group,
              unsigned touching) {
    unsigned found = 0;
    for (unsigned q = 0; q < 8; ++q) {
        const NearEntry& near = to.near[group + q];
        if (((touching >> q) & 1) == 0 &&
            is_held<Law>(to, near, geometry.gap(near), geometry.radius(near)))
            found |= 1u << q;
    }
    return found;
}

/// Computes the forces of a chunk of near rows: lists the rows that touch, then applies the law to
/// lane_count of them at a time. A Geometry describes the surfaces:
///   unsigned touching(near)         bit q: near pair q of lane_count touches
///   double gap(near), radius(near)  of one pair: gap between the surfaces, effective radius, m
///   void prefetch_positions(near)   prefetches what touching() will read for these eight pairs
///   void prefetch_rows(to, rows)    prefetches what the tile after the next will read
///   unsigned collide<Law>(to, rows, count)   applies the law; bits of the lanes whose overlap is
///                                            beyond the limit
template <class Law, class Geometry, class Pairs>
void collide_chunk(const TileTarget& to, const Geometry& geometry, NearIndex<Pairs>& index,
                   std::size_t chunk, std::size_t first, std::size_t last) {
    alignas(64) std::array<Row, near_rows_per_chunk + 8> touching;
    std::size_t count = 0;
    Sleepers<Pairs> sleepers(to, index);
    for (std::size_t group = first; group < last; group += 8) {
        if (sleepers.skips(group)) continue;
        unsigned now = geometry.touching(to.near + group);
        if constexpr (lane_count == 4) now |= geometry.touching(to.near + group + 4) << 4;
        if constexpr (Law::has_reach) now |= held<Law>(to, geometry, group, now);
        if (last - group < 8) now &= (1u << (last - group)) - 1;
        if (group + 56 <= last) geometry.prefetch_positions(to.near + group + 48);
        std::uint8_t& flags = index.touching[group / 8];
        now = sleepers.touching(group, now, flags);
        forget(to, static_cast<Row>(group), flags & ~now);
        flags = static_cast<std::uint8_t>(now);
        now = sleepers.asked(group, now);
        for (; now != 0; now &= now - 1)
            touching[count++] = static_cast<Row>(group) + static_cast<Row>(__builtin_ctz(now));
    }
    if (count == 0) return;
    const bool far = index.size() > near_rows_in_cache;
    for (std::size_t k = 0; k < 8; ++k) touching[count + k] = touching[count - 1];
    for (std::size_t k = 0; k < count; k += lane_count) {
        if (far && k + 3 * lane_count <= count)
            geometry.prefetch_rows(to, &touching[k + 2 * lane_count]);
        const int here = static_cast<int>(std::min<std::size_t>(lane_count, count - k));
        const unsigned deep = geometry.template collide<Law>(to, &touching[k], here);
        if (deep != 0 && index.too_deep[chunk] == no_row)
            index.too_deep[chunk] = touching[k + static_cast<std::size_t>(__builtin_ctz(deep))];
    }
    sleepers.put_springs_back();
}

/// The same for all near rows of a kind of pair, in parallel.
template <class Law, class Geometry, class Pairs>
void collide_all(const TileTarget& to, const Geometry& geometry, NearIndex<Pairs>& index) {
    for_chunks(index.size(), near_rows_per_chunk,
               [&](std::size_t chunk, std::size_t first, std::size_t last) {
                   collide_chunk<Law>(to, geometry, index, chunk, first, last);
               });
    index.look.clear();
}

} // namespace bris::detail

#include "engine/ordering.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace bris {

namespace {

std::uint64_t spread(std::uint64_t v) {
    v &= 0x1fffff;
    v = (v | v << 32) & 0x1f00000000ffffu;
    v = (v | v << 16) & 0x1f0000ff0000ffu;
    v = (v | v << 8) & 0x100f00f00f00f00fu;
    v = (v | v << 4) & 0x10c30c30c30c30c3u;
    return (v | v << 2) & 0x1249249249249249u;
}

} // namespace

std::vector<Row> rows_by_id(std::span<const EntityId> ids) {
    std::vector<Row> rows(ids.empty() ? 0 : std::size_t{*std::ranges::max_element(ids)} + 1,
                          no_row);
    for (Row r = 0; r < ids.size(); ++r) rows[ids[r]] = r;
    return rows;
}

std::vector<Row> in_order_of_ids(std::span<const EntityId> ids) {
    std::vector<Row> rows = rows_by_id(ids);
    std::erase(rows, no_row);
    return rows;
}

RowIndex::RowIndex(std::span<const EntityId> ids) {
    constexpr std::size_t sparse = 4; // times as many numbers as ids
    if (ids.empty()) return;
    const auto [low, high] = std::ranges::minmax(ids);
    if (const std::size_t numbers = std::size_t{high} - low + 1; numbers <= sparse * ids.size()) {
        lowest_ = low;
        rows_.assign(numbers, no_row);
        for (Row r = 0; r < ids.size(); ++r) rows_[ids[r] - low] = r;
        return;
    }
    slots_.resize(2 * ids.size());
    for (Row r = 0; r < ids.size(); ++r) {
        std::size_t k = slot(ids[r]);
        while (slots_[k].row != no_row) k = (k + 1) % slots_.size();
        slots_[k] = {ids[r], r};
    }
}

std::vector<Row> all_rows(std::size_t n) {
    std::vector<Row> rows(n);
    std::iota(rows.begin(), rows.end(), Row{0});
    return rows;
}

std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return spread(x) | spread(y) << 1 | spread(z) << 2;
}

std::vector<Row> morton_order(std::span<const Vec3> positions, std::span<const EntityId> ids,
                              double cell) {
    Vec3 low = Vec3::Constant(0);
    if (!positions.empty()) low = positions[0];
    for (const Vec3& x : positions) low = low.cwiseMin(x);
    struct Key {
        std::uint64_t code;
        EntityId id;
        Row row;
    };
    std::vector<Key> keys(positions.size());
    for (std::size_t r = 0; r < keys.size(); ++r) {
        const Vec3 c = (positions[r] - low) / cell;
        std::array<std::uint32_t, 3> k;
        for (int a = 0; a < 3; ++a)
            k[static_cast<std::size_t>(a)] = static_cast<std::uint32_t>(std::min(c[a], 2097151.0));
        keys[r] = {morton_code(k[0], k[1], k[2]), ids[r], static_cast<Row>(r)};
    }
    std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
        return a.code != b.code ? a.code < b.code : a.id < b.id;
    });
    std::vector<Row> order(keys.size());
    for (std::size_t r = 0; r < keys.size(); ++r) order[r] = keys[r].row;
    return order;
}

} // namespace bris

#pragma once

#include "engine/entity.hpp"
#include "engine/math.hpp"

#include <span>
#include <vector>

namespace bris {

/// Row of each id: entry i is the row of id i, or no_row. Sums over a scene are taken in this
/// order, so that they do not depend on the order of the rows.
std::vector<Row> rows_by_id(std::span<const EntityId> ids);

/// Sum of a column in the order of `rows`.
inline double sum_by_id(std::span<const Row> rows, std::span<const double> values) {
    double sum = 0;
    for (const Row r : rows) sum += values[r];
    return sum;
}

/// The rows 0 to n - 1.
std::vector<Row> all_rows(std::size_t n);

/// Interleaves the low 21 bits of three cell numbers.
std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z);

/// Order of `positions` along a Morton curve of cells with side `cell` (m, > 0). Ties are ordered
/// by id: the order is total, so every sorting algorithm gives the same result. Entry r is the old
/// row of the new row r.
std::vector<Row> morton_order(std::span<const Vec3> positions, std::span<const EntityId> ids,
                              double cell);

} // namespace bris

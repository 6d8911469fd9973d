#pragma once

#include "engine/entity.hpp"
#include "engine/math.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace bris {

/// Row of each id: entry i is the row of id i, or no_row.
std::vector<Row> rows_by_id(std::span<const EntityId> ids);
/// The rows in the order of their ids, of which some may be missing.
std::vector<Row> in_order_of_ids(std::span<const EntityId> ids);

/// The row of each id, in memory for as many ids as there are, however large they are: of a part of
/// a world, too.
class RowIndex {
public:
    explicit RowIndex(std::span<const EntityId> ids);
    /// no_row where no row has the id.
    Row operator[](EntityId id) const {
        const std::size_t at = std::size_t{id} - lowest_; // of a lower id beyond the end
        if (slots_.empty()) return at < rows_.size() ? rows_[at] : no_row;
        for (std::size_t k = slot(id);; k = (k + 1) % slots_.size()) {
            const Slot& found = slots_[k];
            if (found.row == no_row || found.id == id) return found.row;
        }
    }

private:
    struct Slot {
        EntityId id = 0;
        Row row = no_row;
    };
    std::size_t slot(EntityId id) const {
        constexpr std::uint64_t golden = 0x9e3779b97f4a7c15; // spreads neighbouring ids
        return static_cast<std::size_t>(id * golden >> 32) % slots_.size();
    }

    std::size_t lowest_ = 0;
    std::vector<Row> rows_;   ///< from the lowest id to the highest, where most of them exist
    std::vector<Slot> slots_; ///< else: an id is in its slot or in one of those after it
};

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

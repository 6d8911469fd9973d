#pragma once

#include "engine/ordering.hpp"
#include "systems/broadphase/chunk_lists.hpp"
#include "systems/broadphase/lists.hpp"

#include <functional>
#include <span>
#include <vector>

namespace bris::detail {

/// History of a pair table (Spring, Roll or Worn) by name, kept while the table is rebuilt.
template <class History>
class Kept {
public:
    /// Copies the history of pairs that have any. `row_of`: of each of the `bodies`, by id.
    Kept(const Table& table, const RowIndex& row_of, std::size_t bodies) {
        if (!table.has<History>()) return;
        const auto names = table.column<PairKey>();
        const auto values = table.column<History>();
        first_.assign(bodies + 1, 0);
        for_owners(names, [&](EntityId owner, std::size_t begin, std::size_t end) {
            const Row row = row_of[owner];
            for (std::size_t r = begin; r < end; ++r)
                if (History::keep(values[r])) ++first_[row + 1];
        });
        for (std::size_t b = 0; b < bodies; ++b) first_[b + 1] += first_[b];
        names_.resize(first_.back());
        values_.resize(first_.back());
        for_owners(names, [&](EntityId owner, std::size_t begin, std::size_t end) {
            Row next = first_[row_of[owner]];
            for (std::size_t r = begin; r < end; ++r) {
                if (!History::keep(values[r])) continue;
                names_[next] = names[r];
                values_[next++] = values[r];
            }
        });
    }

    /// History of the pair of that name of the body in row `owner`, or zero. `cursor` starts at
    /// first(owner); each call advances it, so names must be asked for in ascending order.
    typename History::Value find(const PairNames& names, std::size_t owner, Row& cursor) const {
        const Row end = first_[owner + 1];
        while (cursor < end && names_[cursor] < names) ++cursor;
        return cursor < end && names_[cursor] == names ? values_[cursor]
                                                       : typename History::Value{};
    }
    Row first(std::size_t owner) const { return first_[owner]; }

private:
    /// Calls body(owner, begin, end) for the rows of each owner, which are contiguous and sorted,
    /// in parallel.
    template <class Body>
    static void for_owners(std::span<const PairNames> names, Body&& body) {
        for_chunks(names.size(), 4096, [&](std::size_t, std::size_t first, std::size_t last) {
            // an owner belongs to the chunk in which its rows begin
            while (first > 0 && first < last && names[first].owner == names[first - 1].owner)
                ++first;
            while (first < last) {
                std::size_t end = first + 1;
                while (end < names.size() && names[end].owner == names[first].owner) ++end;
                body(names[first].owner, first, end);
                first = end;
            }
        });
    }
    std::vector<Row> first_; // by the owner's row
    std::vector<PairNames> names_;
    std::vector<typename History::Value> values_;
};

/// Copies the kept history into the new rows of a table.
template <class History>
void give_back(Table& table, const Kept<History>& kept, const std::vector<Row>& first) {
    if (!table.has<History>()) return;
    const auto names = table.column<PairKey>();
    const auto values = table.column<History>();
    for_chunks(first.size() - 1, 256, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            if (first[b] == first[b + 1]) continue;
            Row cursor = kept.first(b);
            for (Row r = first[b]; r < first[b + 1]; ++r)
                values[r] = kept.find(names[r], b, cursor);
        }
    });
}

/// Makes the rows of a pair table from what was found body by body, and carries the history over.
/// `candidate(entry)` is the Candidate of an entry of the lists.
template <class Pairs, class Entry, class ToCandidate = std::identity>
void replace_pairs(World& world, const ChunkLists<Entry>& found, const std::vector<Row>& first,
                   ToCandidate&& candidate = {}) {
    Table& table = world.table<Pairs>();
    const auto ids = world.column<Bodies, BodyId>();
    const RowIndex row_of(ids);
    const Kept<Spring> springs(table, row_of, ids.size());
    const Kept<Roll> rolls(table, row_of, ids.size());
    const Kept<Worn> worn(table, row_of, ids.size());
    table.resize(0);
    table.resize(found.size());
    const auto names = table.column<PairKey>();
    const auto rows = table.column<PairRows>();
    found.lay_out([&](std::size_t index, const Entry& entry) {
        const Candidate c = candidate(entry);
        names[index] = c.names;
        rows[index] = c.rows;
    });
    world.resource<Candidates<Pairs>>().first = first;
    give_back(table, springs, first);
    give_back(table, rolls, first);
    give_back(table, worn, first);
}

} // namespace bris::detail

#pragma once

#include "engine/ordering.hpp"
#include "systems/broadphase/chunk_lists.hpp"
#include "systems/broadphase/lists.hpp"

#include <algorithm>
#include <atomic>
#include <functional>
#include <numeric>
#include <vector>

namespace bris::detail {

/// History of a pair table (Spring, Roll or Worn) by name, kept while the table is rebuilt.
template <class History>
class Kept {
public:
    /// Copies the history of pairs that have any. `row_of`: of each of the `bodies`, by id.
    Kept(const Table& table, const RowIndex& row_of, std::size_t bodies) : row_of_(row_of) {
        if (!table.has<History>()) return;
        const auto names = table.column<PairKey>();
        const auto values = table.column<History>();
        first_.assign(bodies + 1, 0);
        const auto for_kept = [&](auto&& visit) {
            for_rows(names.size(), [&](Row r) {
                if (History::keep(values[r]))
                    visit(r, std::atomic_ref(first_[row_of[names[r].owner]]));
            });
        };
        for_kept([](Row, auto count) { count.fetch_add(1, std::memory_order_relaxed); });
        std::inclusive_scan(first_.begin(), first_.end(), first_.begin());
        pairs_.resize(first_.back());
        for_kept([&](Row r, auto end) { // from the last pair of each owner to its first
            pairs_[end.fetch_sub(1, std::memory_order_relaxed) - 1] = {names[r], values[r]};
        });
        for_rows(bodies, [&](Row b) {
            std::sort(pairs_.data() + first_[b], pairs_.data() + first_[b + 1],
                      [](const Pair& x, const Pair& y) { return x.names < y.names; });
        });
    }

    /// Writes the history of the same pairs, and zero for others.
    void give_back(Table& table) const {
        if (!table.has<History>()) return;
        const auto names = table.column<PairKey>();
        const auto values = table.column<History>();
        for_rows(names.size(), [&](Row r) { values[r] = find(names[r]); });
    }

private:
    struct Pair {
        PairNames names;
        typename History::Value value;
    };
    typename History::Value find(const PairNames& names) const {
        const Row owner = row_of_[names.owner];
        const auto begin = pairs_.begin() + first_[owner], end = pairs_.begin() + first_[owner + 1];
        const auto found = std::lower_bound(
            begin, end, names, [](const Pair& p, const PairNames& n) { return p.names < n; });
        return found != end && found->names == names ? found->value : typename History::Value{};
    }

    const RowIndex& row_of_;
    std::vector<Row> first_; ///< by the owner's row
    std::vector<Pair> pairs_;
};

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
    springs.give_back(table);
    rolls.give_back(table);
    worn.give_back(table);
}

} // namespace bris::detail

#pragma once

#include "systems/broadphase/chunk_lists.hpp"
#include "systems/broadphase/lists.hpp"

namespace bris::detail {

/// History of a pair table (Spring or Roll) by name, kept while the table is rebuilt.
template <class History>
class Kept {
public:
    /// Copies the history of pairs that have any. `bodies`: number of body ids.
    Kept(const Table& table, std::size_t bodies) {
        if (!table.has<History>()) return;
        const auto names = table.column<PairKey>();
        const auto values = table.column<History>();
        first_.assign(bodies + 1, 0);
        for (std::size_t r = 0; r < table.size(); ++r)
            if (History::keep(values[r])) ++first_[names[r].owner + 1];
        for (std::size_t b = 0; b < bodies; ++b) first_[b + 1] += first_[b];
        kept_.resize(first_.back());
        std::vector<Row> next(first_.begin(), first_.end());
        // the pairs of one owner are contiguous and sorted, so each owner's run stays sorted
        for (std::size_t r = 0; r < table.size(); ++r)
            if (History::keep(values[r])) kept_[next[names[r].owner]++] = {names[r], values[r]};
    }

    /// History of the pair of that name, or zero. `cursor` starts at first(owner); each call
    /// advances it, so names must be asked for in ascending order.
    typename History::Value find(const PairNames& names, Row& cursor) const {
        const Row end = first_[names.owner + 1];
        while (cursor < end && kept_[cursor].names < names) ++cursor;
        if (cursor < end && kept_[cursor].names == names) return kept_[cursor].value;
        return {};
    }
    Row first(EntityId owner) const { return first_[owner]; }

private:
    struct Entry {
        PairNames names;
        typename History::Value value;
    };
    std::vector<Row> first_; // by owner's id
    std::vector<Entry> kept_;
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
            Row cursor = kept.first(names[first[b]].owner);
            for (Row r = first[b]; r < first[b + 1]; ++r) values[r] = kept.find(names[r], cursor);
        }
    });
}

/// Makes the rows of a pair table from candidates collected body by body, and carries the history
/// over.
template <class Pairs>
void replace_pairs(World& world, const ChunkLists<Candidate>& found,
                   const std::vector<Row>& first) {
    Table& table = world.table<Pairs>();
    const Kept<Spring> springs(table, world.table<Bodies>().size());
    const Kept<Roll> rolls(table, world.table<Bodies>().size());
    table.resize(0);
    table.resize(found.size());
    const auto names = table.column<PairKey>();
    const auto rows = table.column<PairRows>();
    found.lay_out([&](std::size_t index, const Candidate& c) {
        names[index] = c.names;
        rows[index] = c.rows;
    });
    world.resource<Candidates<Pairs>>().first = first;
    give_back(table, springs, first);
    give_back(table, rolls, first);
}

} // namespace bris::detail

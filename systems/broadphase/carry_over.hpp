#pragma once

#include "systems/broadphase/chunk_lists.hpp"
#include "systems/broadphase/lists.hpp"

namespace bris::detail {

/// Springs of a pair table by name, kept while the table is made anew.
class KeptSprings {
public:
    /// Takes the stretched springs of the table; `bodies`: number of body ids.
    KeptSprings(const Table& table, std::size_t bodies) {
        if (!table.has<Spring>()) return;
        const auto names = table.column<PairKey>();
        const auto springs = table.column<Spring>();
        first_.assign(bodies + 1, 0);
        for (std::size_t r = 0; r < table.size(); ++r)
            if (Spring::keep(springs[r])) ++first_[names[r].owner + 1];
        for (std::size_t b = 0; b < bodies; ++b) first_[b + 1] += first_[b];
        kept_.resize(first_.back());
        std::vector<Row> next(first_.begin(), first_.end());
        // pairs of one owner stand together and in order, so each owner's run stays in order
        for (std::size_t r = 0; r < table.size(); ++r)
            if (Spring::keep(springs[r])) kept_[next[names[r].owner]++] = {names[r], springs[r]};
    }

    /// Spring of the pair of that name, or zero. `cursor` starts at first(owner) and is moved on by
    /// calls in ascending order.
    SpringRow find(const PairNames& names, Row& cursor) const {
        const Row end = first_[names.owner + 1];
        while (cursor < end && kept_[cursor].names < names) ++cursor;
        if (cursor < end && kept_[cursor].names == names) return kept_[cursor].spring;
        return {};
    }
    Row first(EntityId owner) const { return first_[owner]; }

private:
    struct Kept {
        PairNames names;
        SpringRow spring;
    };
    std::vector<Row> first_; // by owner's id
    std::vector<Kept> kept_;
};

/// Makes the rows of a pair table from candidates collected body by body, springs carried over.
template <class Pairs>
void replace_pairs(World& world, const ChunkLists<Candidate>& found, const std::vector<Row>& first) {
    Table& table = world.table<Pairs>();
    const KeptSprings kept(table, world.table<Bodies>().size());
    table.resize(0);
    table.resize(found.size());
    const auto names = table.column<PairKey>();
    const auto rows = table.column<PairRows>();
    found.lay_out([&](std::size_t place, const Candidate& c) {
        names[place] = c.names;
        rows[place] = c.rows;
    });
    world.resource<Candidates<Pairs>>().first = first;
    if (!table.has<Spring>()) return;
    const auto springs = table.column<Spring>();
    for_chunks(first.size() - 1, 256, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            if (first[b] == first[b + 1]) continue;
            Row cursor = kept.first(names[first[b]].owner);
            for (Row r = first[b]; r < first[b + 1]; ++r) springs[r] = kept.find(names[r], cursor);
        }
    });
}

} // namespace bris::detail

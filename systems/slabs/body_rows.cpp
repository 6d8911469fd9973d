#include "systems/slabs/body_rows.hpp"

#include "components/body.hpp"
#include "components/force_sums.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "components/sphere.hpp"
#include "engine/ordering.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <optional>
#include <stdexcept>

namespace bris::detail {

namespace {

/// The rows of a pair table that have a history, by the row of their owner.
class PairsOfOwners {
public:
    PairsOfOwners(const Table& pairs, const RowIndex& row_of, std::size_t bodies)
        : first_(bodies + 1, 0) {
        std::vector<const Column*> histories;
        for (const auto& column : pairs.columns())
            if (column->type().keep != nullptr) histories.push_back(column.get());
        const auto names = pairs.column<PairKey>();
        const auto has_history = [&](Row r) {
            return std::ranges::any_of(histories, [r](const Column* c) {
                return c->type().keep(c->bytes() + r * c->type().value_size);
            });
        };
        std::vector<Row> kept;
        for (Row r = 0; r < names.size(); ++r)
            if (has_history(r)) kept.push_back(r);
        for (const Row r : kept) ++first_[row_of[names[r].owner] + 1];
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        rows_.resize(kept.size());
        std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
        for (const Row r : kept) rows_[next[row_of[names[r].owner]]++] = r;
    }
    std::span<const Row> of(Row owner) const {
        return {rows_.data() + first_[owner], first_[owner + 1] - first_[owner]};
    }

private:
    std::vector<std::size_t> first_;
    std::vector<Row> rows_;
};

std::vector<Row> spheres_of(const World& world, std::span<const Row> bodies) {
    const auto run = world.column<Bodies, SpheresOf>();
    std::vector<Row> rows;
    for (const Row b : bodies)
        for (Row k = run[b].first; k < run[b].first + run[b].count; ++k) rows.push_back(k);
    return rows;
}

template <class Pairs>
std::vector<Row> pairs_of(const World& world, std::span<const Row> bodies) {
    const auto id = world.column<Bodies, BodyId>();
    const PairsOfOwners pairs(world.table<Pairs>(), RowIndex(id), id.size());
    std::vector<Row> rows;
    for (const Row b : bodies)
        for (const Row r : pairs.of(b)) rows.push_back(r);
    return rows;
}

void pack(const Table& table, std::span<const Row> rows, Ranks::Bytes& bytes) {
    const auto append = [&](const void* data, std::size_t size) {
        const auto* from = static_cast<const std::byte*>(data);
        bytes.insert(bytes.end(), from, from + size);
    };
    const std::uint64_t count = rows.size();
    append(&count, sizeof count);
    for (const auto& column : table.columns()) {
        if (!column->type().is_carried) continue;
        const std::size_t width = column->type().value_size, at = bytes.size();
        bytes.resize(at + rows.size() * width);
        for (std::size_t i = 0; i < rows.size(); ++i)
            std::memcpy(bytes.data() + at + i * width, column->bytes() + rows[i] * width, width);
    }
}

/// Reads what `pack` wrote, table by table.
class Unpacker {
public:
    explicit Unpacker(const Ranks::Bytes& bytes) : bytes_(bytes) {}

    void append_to(Table& table) {
        const std::size_t count = number(), first = table.size();
        table.resize(first + count);
        for (const auto& column : table.columns())
            if (const auto& type = column->type(); type.is_carried)
                std::memcpy(column->bytes() + first * type.value_size,
                            take(count * type.value_size), count * type.value_size);
    }

private:
    const std::byte* take(std::size_t size) {
        if (size > bytes_.size() - at_)
            throw std::logic_error("bodies from another rank: too few bytes");
        at_ += size;
        return bytes_.data() + (at_ - size);
    }
    std::size_t number() {
        std::uint64_t count = 0;
        std::memcpy(&count, take(sizeof count), sizeof count);
        return count;
    }
    const Ranks::Bytes& bytes_;
    std::size_t at_ = 0;
};

std::vector<Row> bodies_of(const World& world, bool with_spheres) {
    const auto ids = world.column<Bodies, BodyId>();
    const RowIndex row_of(ids);
    std::vector<bool> has_spheres(ids.size(), false);
    for (const EntityId parent : world.column<Spheres, ParentId>())
        has_spheres[row_of[parent]] = true;
    std::vector<Row> rows;
    for (Row b = 0; b < ids.size(); ++b)
        if (has_spheres[b] == with_spheres) rows.push_back(b);
    return rows;
}

/// The rows of the bodies without spheres, and then those of `bodies`.
std::vector<Row> with_boundaries(const World& world, std::span<const Row> bodies) {
    std::vector<Row> rows = boundaries_of(world);
    rows.insert(rows.end(), bodies.begin(), bodies.end());
    return rows;
}

template <class Visit>
void for_pair_tables(const World& world, Visit&& visit) {
    for_each_kind_of_pair([&]<class Pairs>() {
        if (world.has<Pairs>()) visit.template operator()<Pairs>();
    });
}

} // namespace

Ranks::Bytes pack_bodies(const World& world, std::span<const Row> bodies) {
    Ranks::Bytes bytes;
    pack(world.table<Bodies>(), bodies, bytes);
    pack(world.table<Spheres>(), spheres_of(world, bodies), bytes);
    for_pair_tables(world, [&]<class Pairs>() {
        pack(world.table<Pairs>(), pairs_of<Pairs>(world, bodies), bytes);
    });
    return bytes;
}

void append_bodies(World& world, const Ranks::Bytes& packed) {
    if (packed.empty()) return;
    Unpacker from(packed);
    from.append_to(world.table<Bodies>());
    from.append_to(world.table<Spheres>());
    for_pair_tables(world, [&]<class Pairs>() { from.append_to(world.table<Pairs>()); });
}

std::vector<Row> boundaries_of(const World& world) { return bodies_of(world, false); }
std::vector<Row> grains_of(const World& world) { return bodies_of(world, true); }

void keep_bodies(World& world, std::span<const Row> bodies) {
    const std::vector<Row> kept = with_boundaries(world, bodies);
    for_pair_tables(
        world, [&]<class Pairs>() { world.table<Pairs>().keep(pairs_of<Pairs>(world, bodies)); });
    world.table<Spheres>().keep(spheres_of(world, bodies));
    world.table<Bodies>().keep(kept);
}

std::optional<std::vector<Row>> rows_of_bodies(const World& world, std::span<const Row> bodies,
                                               const Table& table) {
    if (table.name() == Bodies::name) return std::vector<Row>(bodies.begin(), bodies.end());
    if (table.name() == Spheres::name) return spheres_of(world, bodies);
    std::optional<std::vector<Row>> rows;
    for_pair_tables(world, [&]<class Pairs>() {
        if (table.name() == Pairs::name) rows = pairs_of<Pairs>(world, bodies);
    });
    return rows;
}

bool is_of_bodies(const Table& table) {
    bool is = table.name() == Bodies::name || table.name() == Spheres::name ||
              table.name() == Listed::name || table.name() == ForceSums::name;
    for_each_kind_of_pair([&]<class Pairs>() {
        is = is || table.name() == Pairs::name || table.name() == Pairs::Near::name;
    });
    return is;
}

World copy_of_bodies(const World& whole, std::span<const Row> bodies) {
    const auto rows_of = [&](const Table& table) -> std::optional<std::vector<Row>> {
        if (table.name() == Bodies::name) return with_boundaries(whole, bodies);
        auto rows = rows_of_bodies(whole, bodies, table);
        if (!rows && is_of_bodies(table)) rows.emplace();
        return rows;
    };
    World part(whole, rows_of);
    for_pair_tables(whole, [&]<class Pairs>() { part.resource<NearIndex<Pairs>>() = {}; });
    return part;
}

} // namespace bris::detail

#include "systems/broadphase/force_targets.hpp"

#include "components/body.hpp"
#include "components/force_sums.hpp"
#include "components/kinds.hpp"
#include "engine/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <type_traits>

namespace bris::detail {

namespace {

/// Near rows per chunk. The forces between chunks take a detour over lists, so there are no more
/// chunks than keep all threads busy. Chunks of contacts with boundaries are so small that even
/// contacts at twice the limit of overlap cannot leave the range of their sum.
template <class Pairs>
std::size_t rows_per_chunk(std::size_t rows) {
    if (!std::is_same_v<Pairs, SpherePairs>) return 128;
    constexpr std::size_t least = 256, chunks_per_thread = 4;
    const std::size_t threads = team_size();
    return threads == 1 ? rows : std::max(rows / (chunks_per_thread * threads), least);
}

/// Bodies outside a chunk on which its contacts may exert forces, sorted.
template <class Pairs>
class Outside {
public:
    explicit Outside(World& world)
        : index_(world.resource<NearIndex<Pairs>>()),
          near_(world.column<typename Pairs::Near, NearPair>()),
          pairs_(world.column<Pairs, PairRows>()),
          target_(world.column<typename Pairs::Near, PartnerSum>()), bodies_(index_.chunks.size()) {
        for_each_chunk([&](std::size_t c, const NearChunk& here) {
            for (Row k = here.first; k < here.last; ++k)
                if (const Row b = partner(k); !owns(here, b)) bodies_[c].push_back(b);
            std::ranges::sort(bodies_[c]);
            const auto repeated = std::ranges::unique(bodies_[c]);
            bodies_[c].erase(repeated.begin(), repeated.end());
        });
    }
    std::size_t count() const {
        std::size_t n = 0;
        for (const auto& list : bodies_) n += list.size();
        return n;
    }
    /// Gives each outside body of each chunk a row of ForceSums, from row `first` on.
    void assign_rows(std::size_t first, std::span<Row> next, std::span<Row> list_of) {
        std::vector<std::size_t> start;
        for (const auto& list : bodies_) {
            start.push_back(first);
            first += list.size();
        }
        for_each_chunk([&](std::size_t c, const NearChunk& here) {
            for (std::size_t i = 0; i < bodies_[c].size(); ++i) {
                const auto row = static_cast<Row>(start[c] + i);
                // pushed onto the body's list; the order does not matter, as integers are added
                next[row] = std::atomic_ref(list_of[bodies_[c][i]]).exchange(row);
            }
            for (Row k = here.first; k < here.last; ++k) {
                const Row b = partner(k);
                const auto at = std::ranges::lower_bound(bodies_[c], b) - bodies_[c].begin();
                target_[k] =
                    owns(here, b) ? b : static_cast<Row>(start[c] + static_cast<std::size_t>(at));
            }
        });
        for (std::size_t k = index_.size(); k < target_.size(); ++k)
            target_[k] = 0; // of padding, which is never stored
    }

private:
    Row partner(Row near_row) const { return pairs_[near_[near_row].pair].partner_body; }
    /// Boundaries belong to no chunk, because the units of their torques differ.
    static bool owns(const NearChunk& chunk, Row body) {
        return std::is_same_v<Pairs, SpherePairs> && body >= chunk.first_body &&
               body < chunk.last_body;
    }
    template <class Visit>
    void for_each_chunk(Visit&& visit) {
        for_chunks(index_.chunks.size(), 1,
                   [&](std::size_t c, std::size_t, std::size_t) { visit(c, index_.chunks[c]); });
    }
    const NearIndex<Pairs>& index_;
    std::span<const NearEntry> near_;
    std::span<const PairRowNumbers> pairs_;
    std::span<Row> target_;
    std::vector<std::vector<Row>> bodies_;
};

} // namespace

template <class Pairs>
void divide_into_chunks(NearIndex<Pairs>& index) {
    const std::size_t rows = index.size(), target = rows_per_chunk<Pairs>(rows);
    const std::vector<Row>& owned = index.owned_first;
    index.chunks.clear();
    std::size_t flags = 0;
    for (Row body = 0; owned[body] < rows;) {
        const auto next =
            std::upper_bound(owned.begin() + body + 1, owned.end(), owned[body] + target);
        const auto last = std::max<Row>(static_cast<Row>(next - owned.begin()) - 1, body + 1);
        index.chunks.push_back({body, last, owned[body], owned[last], flags});
        flags += (owned[last] - owned[body] + index.group - 1) / index.group;
        body = last;
    }
    index.beyond_limit.assign(index.chunks.size(), no_row);
    index.touching.assign(flags, 0);
    for (const NearChunk& c : index.chunks) {
        const Row count = c.last - c.first;
        for (Row k = 0; k < count; k += index.group) {
            const unsigned valid = std::min<unsigned>(index.group, count - k);
            index.touching[c.first_flags + k / index.group] =
                static_cast<std::uint8_t>((1u << valid) - 1);
        }
    }
}
template void divide_into_chunks(NearIndex<SpherePairs>&);
template void divide_into_chunks(NearIndex<PlanePairs>&);
template void divide_into_chunks(NearIndex<FacetPairs>&);
template void divide_into_chunks(NearIndex<MembranePairs>&);

void direct_forces(World& world) {
    const auto list_of = world.column<Bodies, SumsFromOthers>();
    std::ranges::fill(list_of, no_row);
    Table& sums = world.table<ForceSums>(); // all of them are 0 between two steps
    sums.resize(list_of.size());
    for_each_kind_of_pair([&]<class Pairs>() {
        if (!world.has<Pairs>()) return;
        Outside<Pairs> outside(world);
        const std::size_t first = sums.size();
        sums.resize(first + outside.count());
        outside.assign_rows(first, sums.column<NextSum>(), list_of);
    });
}

} // namespace bris::detail

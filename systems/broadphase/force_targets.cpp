#include "systems/broadphase/force_targets.hpp"

#include "components/body.hpp"
#include "components/force_sums.hpp"
#include "components/kinds.hpp"
#include "engine/parallel.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>
#include <type_traits>

namespace bris::detail {

namespace {

/// Near rows of contacts with boundaries per chunk: so few that even contacts at twice the limit of
/// overlap cannot leave the range of their sum, and of planes, which take least to begin with, so
/// few that 64 threads find work in a bed of 16 000 spheres. Whether a sum leaves the range must
/// not depend on the threads.
template <class Pairs>
constexpr std::size_t boundary_rows_per_chunk = std::is_same_v<Pairs, PlanePairs> ? 64 : 128;

/// Cuts the bodies into chunks, one after another.
template <class Pairs>
class ChunkCutter {
public:
    explicit ChunkCutter(NearIndex<Pairs>& index) : index_(index) { index_.chunks.clear(); }
    /// Near rows of the bodies before `body` that are in no chunk yet.
    Row rows_before(Row body) const { return index_.owned_first[body] - index_.owned_first[next_]; }
    /// Ends a chunk before this body. Without near rows its bodies go into the next one.
    void end_before(Row body) {
        const Row first = index_.owned_first[next_], last = index_.owned_first[body];
        if (first == last) return;
        index_.chunks.push_back({next_, body, first, last, flags_, 0, 0});
        flags_ += (last - first + index_.group - 1) / index_.group;
        next_ = body;
    }
    std::size_t flags() const { return flags_; }

private:
    NearIndex<Pairs>& index_;
    Row next_ = 0;          ///< first body that is in no chunk yet
    std::size_t flags_ = 0; ///< bytes of `touching`
};

/// Work of the contacts of each body, in units of a near pair that does not touch.
class Work {
public:
    explicit Work(const World& world)
        : near_(world.column<NearSpheres, NearPair>()),
          owned_(world.resource<NearIndex<SpherePairs>>().owned_first) {
        const Table& pairs = world.table<SpherePairs>();
        if (pairs.has<Spring>()) spring_ = pairs.column<Spring>();
    }
    std::uint64_t of(Row body) const {
        constexpr std::uint64_t of_contact = 16;
        std::uint64_t sum = 0;
        for (Row k = owned_[body]; k < owned_[body + 1]; ++k)
            sum += !spring_.empty() && Spring::keep(spring_[near_[k].pair]) ? of_contact : 1;
        return sum;
    }

private:
    std::span<const NearEntry> near_;
    std::span<const SpringRow> spring_; ///< empty where the law has no history
    const std::vector<Row>& owned_;
};

/// Cuts the bodies so that each thread has a part of equal work. Its chunks become smaller towards
/// the end of the part, so that a thread that is delayed leaves little to wait for; there are no
/// more, because the forces between chunks take a detour over lists.
void cut_equal_parts(const Work& work, Row bodies, ChunkCutter<SpherePairs>& cutter) {
    constexpr std::array<double, 4> ends{0.5, 0.75, 0.875, 1}; // of the chunks of a part
    constexpr std::size_t least = 200; // near rows of a part, of some ten microseconds
    const std::size_t threads =
        std::min<std::size_t>(team_size(), cutter.rows_before(bodies) / least);
    if (threads <= 1) return;
    std::vector<std::uint64_t> of_body(bodies);
    for_rows(bodies, [&](Row b) { of_body[b] = work.of(b); });
    const std::uint64_t all = std::accumulate(of_body.begin(), of_body.end(), std::uint64_t{0});
    std::uint64_t done = 0;
    std::size_t cut = 0;
    const auto next_cut = [&] {
        return (static_cast<double>(cut / ends.size()) + ends[cut % ends.size()]) *
               static_cast<double>(all) / static_cast<double>(threads);
    };
    const std::size_t last = threads * ends.size() - 1; // of the cuts: the end of all bodies
    for (Row b = 0; b < bodies && cut < last; ++b) {
        done += of_body[b];
        if (static_cast<double>(done) < next_cut()) continue;
        cutter.end_before(b + 1);
        while (cut < last && next_cut() <= static_cast<double>(done)) ++cut;
    }
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
        if (std::is_same_v<Pairs, SpherePairs> && index_.chunks.size() > 1) note_across();
        for (std::size_t k = index_.size(); k < target_.size(); ++k)
            target_[k] = 0; // of padding, which is never stored
    }

private:
    void note_across() {
        index_.across.clear();
        for (NearChunk& here : index_.chunks) {
            here.first_across = index_.across.size();
            for (Row k = here.first; k < here.last; ++k)
                if (!owns(here, target_[k])) index_.across.push_back(k);
            here.last_across = index_.across.size();
        }
    }
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
    NearIndex<Pairs>& index_;
    std::span<const NearEntry> near_;
    std::span<const PairRowNumbers> pairs_;
    std::span<Row> target_;
    std::vector<std::vector<Row>> bodies_;
};

} // namespace

template <class Pairs>
void divide_into_chunks(World& world) {
    auto& index = world.resource<NearIndex<Pairs>>();
    const Row bodies = static_cast<Row>(index.owned_first.size()) - 1;
    ChunkCutter<Pairs> cutter(index);
    if constexpr (std::is_same_v<Pairs, SpherePairs>) {
        cut_equal_parts(Work(world), bodies, cutter);
    } else {
        for (Row b = 0; b < bodies; ++b)
            if (cutter.rows_before(b + 1) > boundary_rows_per_chunk<Pairs>) cutter.end_before(b);
    }
    cutter.end_before(bodies);
    index.beyond_limit.assign(index.chunks.size(), no_row);
    index.touching.assign(cutter.flags(), 0);
    for (const NearChunk& c : index.chunks) {
        const Row count = c.last - c.first;
        for (Row k = 0; k < count; k += index.group) {
            const unsigned valid = std::min<unsigned>(index.group, count - k);
            index.touching[c.first_flags + k / index.group] =
                static_cast<std::uint8_t>((1u << valid) - 1);
        }
    }
}
template void divide_into_chunks<SpherePairs>(World&);
template void divide_into_chunks<PlanePairs>(World&);
template void divide_into_chunks<FacetPairs>(World&);
template void divide_into_chunks<MembranePairs>(World&);

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

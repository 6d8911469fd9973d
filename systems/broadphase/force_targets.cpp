#include "systems/broadphase/force_targets.hpp"

#include "components/body.hpp"
#include "components/force_sums.hpp"
#include "components/kinds.hpp"
#include "components/late_bodies.hpp"
#include "components/sphere.hpp"
#include "engine/parallel.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <numeric>
#include <type_traits>

namespace bris::detail {

namespace {

/// Near rows of contacts with boundaries per chunk: so few that 64 threads find work in a bed of
/// 16 000 spheres, and that even contacts at twice the limit of overlap cannot leave the range of
/// their sum. Whether they do must not depend on the threads.
constexpr std::size_t boundary_rows_per_chunk = 32;

/// Cuts the bodies into chunks, one after another.
template <class Pairs>
class ChunkCutter {
public:
    explicit ChunkCutter(NearIndex<Pairs>& index) : index_(index) { index_.chunks.clear(); }
    /// Near rows of the bodies before `body` that are in no chunk yet.
    Row rows_before(Row body) const {
        return index_.listed_first[body] - index_.listed_first[next_];
    }
    /// Ends a chunk before this body, unless the last one has ended there.
    void end_before(Row body) {
        if (body == next_) return;
        const Row first = index_.listed_first[next_], last = index_.listed_first[body];
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

/// Work of each body, in units of a near pair that does not touch.
class Work {
public:
    explicit Work(const World& world)
        : near_(world.column<NearSpheres, NearPair>()),
          index_(world.resource<NearIndex<SpherePairs>>()) {
        const Table& pairs = world.table<SpherePairs>();
        if (pairs.has<Spring>()) spring_ = pairs.column<Spring>();
    }
    std::uint64_t of(Row body) const {
        constexpr std::uint64_t of_contact = 16, of_motion = 16;
        std::uint64_t sum = index_.lets_bodies_move() ? of_motion : 0;
        for (Row k = index_.listed_first[body]; k < index_.listed_first[body + 1]; ++k)
            sum += !spring_.empty() && Spring::keep(spring_[near_[k].pair]) ? of_contact : 1;
        return sum;
    }

private:
    std::span<const NearEntry> near_;
    std::span<const SpringRow> spring_; ///< empty where the law has no history
    const NearIndex<SpherePairs>& index_;
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
          pairs_(world.column<Pairs, PairRows>()), body_(world.column<Listed, ListedBody>()),
          target_(world.column<typename Pairs::Near, SumRows>()), bodies_(index_.chunks.size()) {
        for_each_chunk([&](std::size_t c, const NearChunk& here) {
            for_near(here, [&](Row, Row, Row other, bool) {
                if (!owns(here, other)) bodies_[c].push_back(other);
            });
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
            for_near(here, [&](Row k, Row lister, Row other, bool lister_owns) {
                const auto at = std::ranges::lower_bound(bodies_[c], other) - bodies_[c].begin();
                const Row outer = owns(here, other)
                                      ? other
                                      : static_cast<Row>(start[c] + static_cast<std::size_t>(at));
                target_[k] =
                    lister_owns ? SumRowNumbers{lister, outer} : SumRowNumbers{outer, lister};
            });
        });
        if (std::is_same_v<Pairs, SpherePairs> && index_.chunks.size() > 1) note_across();
        for (std::size_t k = index_.size(); k < target_.size(); ++k)
            target_[k] = {0, 0}; // of padding, which is never stored
    }

private:
    void note_across() {
        index_.across.clear();
        for (NearChunk& here : index_.chunks) {
            here.first_across = index_.across.size();
            for (Row k = here.first; k < here.last; ++k)
                if (!owns(here, target_[k].owner) || !owns(here, target_[k].partner))
                    index_.across.push_back(k);
            here.last_across = index_.across.size();
        }
    }
    /// Calls visit(near row, body that lists it, its other body, whether the former owns it).
    template <class Visit>
    void for_near(const NearChunk& chunk, Visit&& visit) const {
        for (Row b = chunk.first_body; b < chunk.last_body; ++b)
            for (Row k = index_.listed_first[b]; k < index_.listed_first[b + 1]; ++k) {
                const Row partner = pairs_[near_[k].pair].partner_body;
                visit(k, b, partner == b ? body_[near_[k].owner] : partner, partner != b);
            }
    }
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
    std::span<const Row> body_;
    std::span<SumRowNumbers> target_;
    std::vector<std::vector<Row>> bodies_;
};

/// Notes which groups of bodies another chunk of near rows of spheres than their own pushes.
class LateGroups {
public:
    explicit LateGroups(World& world)
        : list_of_(world.column<Bodies, SumsFromOthers>()),
          spheres_(world.column<Bodies, SpheresOf>()),
          is_late_(world.resource<LateBodies>().is_late) {}

    void note(const std::vector<NearChunk>& chunks) {
        const Row groups = (bodies() + group - 1) / group;
        is_late_.assign(groups, 0);
        for (const NearChunk& c : chunks)
            mark(c, c.last_body == bodies() ? groups : c.last_body / group);
    }

private:
    static constexpr Row group = LateBodies::group;

    Row bodies() const { return static_cast<Row>(list_of_.size()); }
    /// `last`: the first group that does not end in the chunk.
    void mark(const NearChunk& chunk, Row last) {
        constexpr Row fewest = 4; // groups that are worth a call
        const Row first = chunk.first_body / group;
        Row begin = first; // of those that are not late
        for (Row g = first; g < last; ++g) {
            is_late_[g] = g * group < chunk.first_body || has_list(g);
            if (is_late_[g] == 0) continue;
            if (g - begin < fewest) std::fill_n(&is_late_[begin], g - begin, std::uint8_t{1});
            begin = g + 1;
        }
    }
    /// Whether contacts of spheres push one of its bodies from another chunk.
    bool has_list(Row g) const {
        for (Row b = g * group; b < std::min((g + 1) * group, bodies()); ++b)
            if (list_of_[b] != no_row && spheres_[b].count > 0) return true;
        return false;
    }
    std::span<const Row> list_of_;
    std::span<const SphereRun> spheres_;
    std::vector<std::uint8_t>& is_late_;
};

} // namespace

template <class Pairs>
void divide_into_chunks(World& world) {
    auto& index = world.resource<NearIndex<Pairs>>();
    const Row bodies = static_cast<Row>(index.listed_first.size()) - 1;
    ChunkCutter<Pairs> cutter(index);
    if constexpr (std::is_same_v<Pairs, SpherePairs>) {
        cut_equal_parts(Work(world), bodies, cutter);
    } else {
        for (Row b = 0; b < bodies; ++b)
            if (cutter.rows_before(b) > 0 && cutter.rows_before(b + 1) > boundary_rows_per_chunk)
                cutter.end_before(b);
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
    const auto& index = world.resource<NearIndex<SpherePairs>>();
    if (index.lets_bodies_move()) LateGroups(world).note(index.chunks);
}

} // namespace bris::detail

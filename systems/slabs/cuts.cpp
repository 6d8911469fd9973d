#include "systems/slabs/cuts.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "engine/ranks.hpp"
#include "systems/slabs/body_rows.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>

namespace bris::detail {

namespace {

/// Fine enough for slabs of equal work, however many there are.
std::size_t bins_along() {
    constexpr std::size_t fewest = 4096, of_rank = 64;
    return std::max(fewest, of_rank * Ranks::size());
}
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Calls visit(row) for the bodies with spheres that are no ghosts.
template <class Visit>
void for_grains(const World& world, std::span<const std::uint32_t> ghost, Visit&& visit) {
    const auto run = world.column<Bodies, SpheresOf>();
    for (Row b = 0; b < run.size(); ++b)
        if (run[b].count > 0 && (ghost.empty() || ghost[b] == 0)) visit(b);
}

Work extent_along(const World& world, int axis, std::span<const std::uint32_t> ghost) {
    const auto position = world.column<Bodies, Position>();
    Work work{infinity, -infinity, std::vector<std::int64_t>(bins_along())};
    for_grains(world, ghost, [&](Row b) {
        work.low = std::min(work.low, position[b][axis]);
        work.high = std::max(work.high, position[b][axis]);
    });
    return work;
}

void fill(Work& work, const World& world, int axis, std::span<const std::uint32_t> ghost) {
    const auto position = world.column<Bodies, Position>();
    const auto run = world.column<Bodies, SpheresOf>();
    const auto& first = world.resource<NearIndex<SpherePairs>>().owned_first;
    const bool has_lists = first.size() == run.size() + 1;
    const std::size_t last = work.bins.size() - 1;
    const double width = (work.high - work.low) / static_cast<double>(work.bins.size());
    for_grains(world, ghost, [&](Row b) {
        const double at = width > 0 ? (position[b][axis] - work.low) / width : 0;
        const auto bin = std::min(static_cast<std::size_t>(std::max(at, 0.0)), last);
        work.bins[bin] += run[b].count + (has_lists ? first[b + 1] - first[b] : 0);
    });
}

} // namespace

Work work_along(const World& world, int axis, std::span<const std::uint32_t> ghost) {
    Work work = extent_along(world, axis, ghost);
    fill(work, world, axis, ghost);
    return work;
}

Work work_of_ranks(const World& part, int axis) {
    const auto ghost = part.column<Bodies, Ghost>();
    Work work = extent_along(part, axis, ghost);
    work.low = -Ranks::largest(-work.low);
    work.high = Ranks::largest(work.high);
    fill(work, part, axis, ghost);
    Ranks::sum(work.bins);
    return work;
}

std::vector<double> even_cuts(const Work& work, unsigned ranks) {
    std::vector<double> cuts(ranks + 1, infinity);
    cuts[0] = -infinity;
    std::int64_t total = 0, below = 0;
    for (const std::int64_t bin : work.bins) total += bin;
    unsigned rank = 1;
    for (std::size_t k = 0; k < work.bins.size() && rank < ranks; ++k) {
        below += work.bins[k];
        while (rank < ranks && below * ranks >= total * rank)
            cuts[rank++] = work.low + (work.high - work.low) * static_cast<double>(k + 1) /
                                          static_cast<double>(work.bins.size());
    }
    return cuts;
}

void outline_own_slab(Slab& slab, const World& whole) {
    const auto position = whole.column<Bodies, Position>();
    const Reach reach(whole);
    for_grains(whole, {}, [&](Row b) {
        if (slab.owner_of(position[b][slab.axis]) == slab.rank)
            slab.outline.add(position[b], reach[b]);
    });
}

namespace {

/// The outlines of the bodies that this rank has computed, by the slabs in which they lie now.
std::map<unsigned, Outline> outlines_of_own(const Slab& slab, const World& part) {
    const auto position = part.column<Bodies, Position>();
    const Reach reach(part);
    Outline empty = slab.outline;
    empty.clear();
    std::map<unsigned, Outline> outlines;
    const auto ghost = part.column<Bodies, Ghost>();
    for (const Row b : grains_of(part)) { // a new part has no runs of spheres yet
        if (ghost[b] != 0) continue;
        const Vec3& x = position[b];
        outlines.try_emplace(slab.owner_of(x[slab.axis]), empty).first->second.add(x, reach[b]);
    }
    return outlines;
}

/// How far along the axis the bodies of each slab reach, and those that each rank has computed.
class ExtentsOfRanks {
public:
    ExtentsOfRanks(const Slab& slab, const std::map<unsigned, Outline>& own)
        : extents_(2 * slab.ranks()) {
        for (const auto& [rank, outline] : own) {
            extents_[rank] = outline.extent();
            extents_[slab.ranks() + slab.rank].enlarge(outline.extent());
        }
        Ranks::largest(Outline::numbers_of(extents_));
    }
    /// Whether a rank has or will have bodies that may reach those of another rank's slab.
    bool needs(std::size_t rank, std::size_t slab) const {
        return rank != slab && (extents_[rank].meets(extents_[slab]) ||
                                extents_[extents_.size() / 2 + rank].meets(extents_[slab]));
    }

private:
    std::vector<Outline::Extent> extents_; ///< of each slab, and of what each rank has computed
};

} // namespace

void share_outlines(Slab& slab, const World& part) {
    std::map<unsigned, Outline> own = outlines_of_own(slab, part);
    const ExtentsOfRanks extents(slab, own);
    // each rank puts the outline of its slab together, from those whose bodies lie there now
    std::vector<Ranks::Bytes> to(slab.ranks());
    for (auto& [rank, outline] : own) {
        const auto bytes = std::as_bytes(outline.numbers());
        to[rank].assign(bytes.begin(), bytes.end());
    }
    slab.outline.clear();
    for (const Ranks::Bytes& bytes : Ranks::exchange(to)) {
        if (bytes.empty()) continue;
        Outline some = slab.outline;
        std::memcpy(some.numbers().data(), bytes.data(), bytes.size());
        slab.outline.add(some);
    }
    std::vector<Ranks::Message> send, receive;
    slab.near.clear();
    for (unsigned r = 0; r < slab.ranks(); ++r)
        if (extents.needs(slab.rank, r)) slab.near.push_back({r, slab.outline});
    for (NearSlab& near : slab.near)
        receive.push_back({near.rank, std::as_writable_bytes(near.outline.numbers())});
    for (unsigned r = 0; r < slab.ranks(); ++r)
        if (extents.needs(r, slab.rank))
            send.push_back({r, std::as_writable_bytes(slab.outline.numbers())});
    Ranks::pass(send, receive);
}

void mark_ghosts(World& part) {
    const Slab& slab = part.resource<Slab>();
    const auto position = part.column<Bodies, Position>();
    const auto ghost = part.column<Bodies, Ghost>();
    for (Row b = 0; b < ghost.size(); ++b)
        ghost[b] = slab.owner_of(position[b][slab.axis]) == slab.rank ? 0 : 1;
    for (const Row b : boundaries_of(part)) ghost[b] = 0;
}

} // namespace bris::detail

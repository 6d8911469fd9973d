#include "systems/slabs/cuts.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "engine/ranks.hpp"
#include "systems/slabs/body_rows.hpp"

#include <algorithm>
#include <limits>

namespace bris::detail {

namespace {

constexpr std::size_t bins_along = 4096;
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
    Work work{infinity, -infinity, std::vector<std::int64_t>(bins_along)};
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
    const double width = (work.high - work.low) / static_cast<double>(bins_along);
    for_grains(world, ghost, [&](Row b) {
        const double at = width > 0 ? (position[b][axis] - work.low) / width : 0;
        const auto bin = std::min(static_cast<std::size_t>(std::max(at, 0.0)), bins_along - 1);
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

void add_to_outlines(Slab& slab, const World& world, std::span<const std::uint32_t> ghost) {
    const auto position = world.column<Bodies, Position>();
    const Reach reach(world);
    for_grains(world, ghost, [&](Row b) {
        const Vec3& x = position[b];
        slab.outlines.add(slab.owner_of(x[slab.axis]), x, reach[b]);
    });
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

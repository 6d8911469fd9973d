#include "engine/health.hpp"
#include "engine/ranks.hpp"
#include "systems/slabs/body_rows.hpp"
#include "systems/slabs/cuts.hpp"
#include "systems/slabs/slabs.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace bris {

namespace {

/// All ranks stop for the reason that the first of those in trouble has found.
void share_trouble(Health& health) {
    const auto* text = reinterpret_cast<const std::byte*>(health.what.data());
    for (const auto& what : Ranks::share({text, text + (health.bad ? health.what.size() : 0)}))
        if (!what.empty()) {
            health.what.assign(reinterpret_cast<const char*>(what.data()), what.size());
            break;
        }
    health.bad = true;
}

} // namespace

void agree_on_lists(const Slab&, ListState& lists, Health& health) {
    std::array<double, 3> found{lists.used_up ? 1.0 : 0.0, lists.stale ? 1.0 : 0.0,
                                health.bad ? 1.0 : 0.0};
    Ranks::largest(found);
    lists.used_up = found[0] > 0;
    lists.stale = found[1] > 0;
    if (found[2] > 0) share_trouble(health);
}

void exchange_bodies(Slab& slab, World& world) {
    if (std::exchange(slab.just_taken, false) || !world.resource<ListState>().stale) return;
    slab.cuts = detail::even_cuts(detail::work_of_ranks(world, slab.axis), slab.ranks());
    detail::share_outlines(slab, world);
    const auto ghost = world.column<Bodies, Ghost>();
    const auto run = world.column<Bodies, SpheresOf>();
    const auto position = world.column<Bodies, Position>();
    const detail::Reach reach(world);
    std::vector<std::vector<Row>> near(slab.ranks()); // own bodies, by rank
    for (Row b = 0; b < run.size(); ++b)
        if (ghost[b] == 0 && run[b].count > 0)
            slab.for_slabs_that_need(position[b], reach[b],
                                     [&](unsigned r) { near[r].push_back(b); });
    std::vector<Ranks::Bytes> to(near.size());
    for (unsigned r = 0; r < near.size(); ++r)
        if (r != slab.rank && !near[r].empty()) to[r] = detail::pack_bodies(world, near[r]);
    const auto from = Ranks::exchange(to);
    detail::keep_bodies(world, near[slab.rank]);
    for (const auto& packed : from) detail::append_bodies(world, packed);
    detail::mark_ghosts(world);
}

} // namespace bris

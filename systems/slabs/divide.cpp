#include "components/pair.hpp"
#include "engine/health.hpp"
#include "engine/memory.hpp"
#include "engine/ordering.hpp"
#include "engine/ranks.hpp"
#include "systems/slabs/body_rows.hpp"
#include "systems/slabs/cuts.hpp"
#include "systems/slabs/slabs.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

namespace bris {

namespace {

/// Corners of the box of the centres of all bodies with spheres.
std::pair<Vec3, Vec3> box_of_grains(const World& world) {
    const auto position = world.column<Bodies, Position>();
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Row b : detail::grains_of(world)) {
        low = low.cwiseMin(position[b]);
        high = high.cwiseMax(position[b]);
    }
    return {low, high};
}

/// Rows of the bodies with spheres that this rank computes.
std::vector<Row> own_grains(const World& part) {
    const auto ghost = part.column<Bodies, Ghost>();
    std::vector<Row> own = detail::grains_of(part);
    std::erase_if(own, [&](Row b) { return ghost[b] != 0; });
    return own;
}

/// Removes the bodies of the whole world, which the parts have, with the memory for them and their
/// lists.
void release_bodies(World& whole) {
    for (const auto& named : whole.tables())
        if (detail::is_of_bodies(*named.table)) named.table->release();
    for_each_kind_of_pair([&]<class Pairs>() {
        if (whole.has<Pairs>()) whole.resource<NearIndex<Pairs>>() = {};
    });
    return_free_memory();
}

/// Tables of boundaries and elements are the same on all ranks, and none of their rows move.
void copy_boundaries(const World& part, World& whole) {
    for (const auto& named : whole.tables()) {
        if (detail::is_of_bodies(*named.table)) continue;
        const Table& from = *part.find_table(named.kind);
        for (const auto& column : named.table->columns())
            if (const auto& type = column->type(); type.is_state)
                std::memcpy(column->bytes(), from.find(type.component)->bytes(),
                            from.size() * type.value_size);
    }
}

/// `extent`: m, of the box of grains, along whose longest side the world is divided.
Slab slab_of_this_rank(const World& whole, const Vec3& extent) {
    Slab slab;
    slab.rank = Ranks::rank();
    extent.maxCoeff(&slab.axis);
    slab.cuts = detail::even_cuts(detail::work_along(whole, slab.axis, {}), Ranks::size());
    return slab;
}

} // namespace

unsigned most_slabs(const World& world) {
    const auto radius = world.column<Bodies, BoundingRadius>();
    double largest = 0;
    for (const Row b : detail::grains_of(world)) largest = std::max(largest, radius[b]);
    if (!(largest > 0)) return 1;
    const auto [low, high] = box_of_grains(world);
    const double length = (high - low).maxCoeff() + 2 * largest;
    return std::max(1u, static_cast<unsigned>(length / (4 * largest)));
}

double share_of_ghosts(const World& world) {
    if (!world.has_resource<Slab>()) return 0;
    std::array<std::int64_t, 2> counts{0, 0}; // ghosts, own
    const auto ghost = world.column<Bodies, Ghost>();
    for (const Row b : detail::grains_of(world)) ++counts[ghost[b] != 0 ? 0 : 1];
    Ranks::sum(counts);
    return static_cast<double>(counts[0]) / static_cast<double>(counts[1]);
}

std::vector<unsigned> ranks_of_bodies(const World& whole) {
    const auto [low, high] = box_of_grains(whole);
    const Slab slab = slab_of_this_rank(whole, high - low);
    std::vector<unsigned> ranks;
    for (const Vec3& x : whole.column<Bodies, Position>())
        ranks.push_back(slab.owner_of(x[slab.axis]));
    return ranks;
}

namespace {

/// With an outline that has no bodies yet.
Slab first_slab(World& whole) {
    if (whole.has_resource<SlabPlan>() && !whole.resource<SlabPlan>().cuts.empty()) {
        const SlabPlan plan = std::exchange(whole.resource<SlabPlan>(), {});
        Slab slab;
        slab.rank = Ranks::rank();
        slab.axis = plan.axis;
        slab.cuts = plan.cuts;
        slab.outline = Outline(plan.axis, plan.low, plan.high);
        return slab;
    }
    const auto [low, high] = box_of_grains(whole);
    Slab slab = slab_of_this_rank(whole, high - low);
    slab.outline = Outline(slab.axis, low, high);
    return slab;
}

} // namespace

World take_slab(World& whole) {
    Slab slab = first_slab(whole);
    detail::outline_own_slab(slab, whole);
    std::vector<Row> here;
    const auto position = whole.column<Bodies, Position>();
    const detail::Reach reach(whole);
    const auto run = whole.column<Bodies, SpheresOf>();
    for (Row b = 0; b < run.size(); ++b)
        if (run[b].count > 0 && (slab.owner_of(position[b][slab.axis]) == slab.rank ||
                                 slab.outline.may_touch(position[b], reach[b])))
            here.push_back(b);
    World part = detail::copy_of_bodies(whole, here);
    release_bodies(whole);
    part.table<Bodies>().add<Ghost>();
    part.add_resource(std::move(slab));
    detail::mark_ghosts(part);
    detail::share_outlines(part.resource<Slab>(), part);
    part.resource<ListState>().stale = true;
    part.resource<ListState>().brief = false;
    return part;
}

std::vector<Row> rows_to_save(const World& part, const Table& table) {
    const auto own = own_grains(part);
    if (auto rows = detail::rows_of_bodies(part, own, table)) {
        if (table.name() == Bodies::name && Ranks::is_first()) {
            const auto boundaries = detail::boundaries_of(part);
            rows->insert(rows->end(), boundaries.begin(), boundaries.end());
        }
        return *rows;
    }
    return Ranks::is_first() ? all_rows(table.size()) : std::vector<Row>{};
}

void give_back(const World& part, World& whole) {
    const auto own = own_grains(part);
    detail::append_bodies(whole, detail::pack_bodies(part, detail::boundaries_of(part)));
    for (const auto& packed : Ranks::share(detail::pack_bodies(part, own)))
        detail::append_bodies(whole, packed);
    copy_boundaries(part, whole);
    Archive resources;
    for (const auto& held : part.resources())
        if (!held->changes_in_whole_steps_only) held->save(resources);
    for (const auto& held : whole.resources())
        if (!held->changes_in_whole_steps_only) held->load(resources);
    whole.resource<Health>() = part.resource<Health>();
    whole.resource<ListState>().stale = true;
    whole.resource<ListState>().brief = true;
}

} // namespace bris

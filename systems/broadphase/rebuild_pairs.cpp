#include "components/boundary.hpp"
#include "components/census.hpp"
#include "components/material.hpp"
#include "components/membrane.hpp"
#include "engine/ordering.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/broadphase/skins.hpp"
#include "systems/broadphase/sphere_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace bris {

namespace {

// rows of bodies along a Morton curve; driven bodies too, because they are few
std::vector<Row> sorted_rows(const Table& bodies) {
    double sum = 0;
    for (const double r : bodies.column<BoundingRadius>()) sum += r;
    return sum > 0 ? morton_order(bodies.column<Position>(), bodies.column<BodyId>(),
                                  2 * sum / static_cast<double>(bodies.size()))
                   : all_rows(bodies.size());
}

// changes the order of the bodies, and of their spheres with them: sorted, if asked for, and with
// ghosts at the end. Returns whether anything has moved.
bool order_rows(World& world, bool sort) {
    Table &bodies = world.table<Bodies>(), &spheres = world.table<Spheres>();
    if (!sort && !bodies.has<Ghost>()) return false;
    const Ghosts ghosts(bodies);
    std::vector<Row> order = sort ? sorted_rows(bodies) : all_rows(bodies.size());
    std::stable_partition(order.begin(), order.end(), [&](Row b) { return !ghosts[b]; });
    if (std::ranges::is_sorted(order)) return false;
    const auto run = bodies.column<SpheresOf>();
    std::vector<Row> sphere_order;
    sphere_order.reserve(spheres.size());
    for (const Row b : order)
        for (Row k = run[b].first; k < run[b].first + run[b].count; ++k) sphere_order.push_back(k);
    bodies.keep(order);
    spheres.keep(sphere_order);
    return true;
}

void take_census(World& world) {
    const Table& bodies = world.table<Bodies>();
    const auto radius = bodies.column<BoundingRadius>();
    const auto material = bodies.column<MaterialOf>();
    const auto motion = bodies.column<MotionOf>();
    const auto mass = bodies.column<Mass>();
    const auto spheres = bodies.column<SpheresOf>();
    const Ghosts ghosts(bodies); // count on their own ranks
    const std::size_t materials = world.resource<Materials>().list.size();
    Census census;
    census.smallest_free_radius = std::numeric_limits<double>::infinity();
    census.grains.assign(materials, 0);
    census.hosts.assign(materials, 0);
    for (Row b = 0; b < bodies.size(); ++b) {
        const bool grain = spheres[b].count > 0;
        if (!ghosts[b]) ++(grain ? census.grains : census.hosts)[material[b]];
        if (!grain) census.boundaries.push_back(b);
        if (grain) census.largest_radius = std::max(census.largest_radius, radius[b]);
        if (motion[b] != static_cast<std::uint32_t>(Motion::free)) continue;
        if (grain) census.largest_grain_mass = std::max(census.largest_grain_mass, mass[b]);
        if (radius[b] > 0)
            census.smallest_free_radius = std::min(census.smallest_free_radius, radius[b]);
    }
    world.resource<Census>() = std::move(census);
}

} // namespace

bool lists_are_due(const World& world) {
    const auto& state = world.resource<ListState>();
    if (state.stale || state.used_up) return true;
    const auto skin = world.column<Bodies, InnerSkin>();
    const auto displacement = world.column<Bodies, DisplacementBound>();
    for (const Row b : world.resource<Census>().boundaries)
        if (!(displacement[b] <= skin[b])) return true;
    return world.has_resource<Membrane>() && !(detail::membrane_moved_since_prune(world) <=
                                               skin[world.resource<Membrane>().body_row]);
}

bool positions_are_due(const World& world) {
    const auto& state = world.resource<ListState>();
    return state.velocities_changed || lists_are_due(world);
}
void note_positions(World& world) { world.resource<ListState>().velocities_changed = false; }
void show_velocities(World& world) { world.resource<ListState>().velocities_changed = true; }
void invalidate_lists(World& world) {
    world.resource<ListState>().stale = true;
    world.resource<MotionColumns>() = {}; // what was changed from outside is current
}

void review_lists(const Slab&, World& world) {
    if (lists_are_due(world)) world.resource<ListState>().note_used_up();
}

void review_candidates(const Slab&, World& world) {
    auto& state = world.resource<ListState>();
    if (!state.used_up) return;
    state.skins_are_chosen = !state.stale && detail::choose_inner_skins(world);
    state.stale = !state.skins_are_chosen;
    if (state.stale) detail::choose_outer_skins(world);
}

void survey(World& world) {
    detail::find_runs(world);
    detail::choose_outer_skins(world);
}

void rebuild_pairs(World& world) {
    auto& state = world.resource<ListState>();
    if (!state.stale &&
        (std::exchange(state.skins_are_chosen, false) || detail::choose_inner_skins(world)))
        return;
    const auto& settings = world.resource<ListSettings>();
    detail::find_runs(world);
    const bool sort = settings.sort_every > 0 && state.rebuilds % settings.sort_every == 0;
    if (order_rows(world, sort)) detail::find_runs(world);
    if (sort) ++state.sorts;
    take_census(world);
    detail::note_poses<RebuiltAt, RebuiltOrientation>(world);
    detail::note_membrane_at_rebuild(world);
    detail::choose_skins(world);
    detail::locate_spheres<OuterSkin>(world);
    detail::find_sphere_pairs(world);
    if (world.has<PlanePairs>()) detail::find_plane_pairs(world);
    if (world.has<FacetPairs>()) detail::find_facet_pairs(world);
    if (world.has<Elements>()) detail::find_membrane_pairs(world);
    if (world.has<Triangles>()) detail::find_triangle_pairs(world);
    state.stale = false;
    state.last_rebuild = world.resource<Clock>().step;
    state.prunes_at_rebuild = state.prunes;
    ++state.rebuilds;
}

} // namespace bris

#include "components/boundary.hpp"
#include "components/membrane_surface.hpp"
#include "components/near_spheres.hpp"
#include "systems/broadphase/chunk_lists.hpp"
#include "systems/broadphase/flat_parts.hpp"
#include "systems/broadphase/force_targets.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/broadphase/skins.hpp"
#include "systems/broadphase/sphere_rows.hpp"

#include <algorithm>
#include <atomic>
#include <span>
#include <type_traits>

namespace bris {

namespace {

/// Clears the history of pairs that are no longer near. Of old candidates, only those that were
/// near can have any.
template <class Pairs, class Near>
void forget_separated(World& world, Near&& near_bits) {
    Table& pairs = world.table<Pairs>();
    if (!pairs.has<Spring>()) return;
    const auto rows = pairs.column<PairRows>();
    const PairHistory history{pairs.column<Spring>().data(),
                              pairs.has<Roll>() ? pairs.column<Roll>().data() : nullptr,
                              pairs.has<Worn>() ? pairs.column<Worn>().data() : nullptr};
    const auto forget_if_separated = [&](Row pair) {
        if (history.is_kept(pair) && near_bits(&rows[pair], 1u) == 0) history.clear(pair);
    };
    const auto& state = world.resource<ListState>();
    if (state.last_rebuild == world.resource<Clock>().step)
        return for_rows(rows.size(), forget_if_separated);
    const auto old = world.column<typename Pairs::Near, NearPair>();
    for_rows(world.resource<NearIndex<Pairs>>().size(),
             [&](Row k) { forget_if_separated(old[k].pair); });
}

// Lists the pairs of one kind within the inner skins, body by body, and clears the springs of the
// others. `near_bits` returns bits for up to lane_count candidates: set where the pair is near.
template <class Pairs, class Near>
void list_near(World& world, Near&& near_bits) {
    forget_separated<Pairs>(world, near_bits);
    const auto rows = world.column<Pairs, PairRows>();
    const auto& candidates = world.resource<detail::Candidates<Pairs>>().first;
    auto& index = world.resource<NearIndex<Pairs>>();
    detail::ChunkLists<NearEntry> found;
    found.collect(
        candidates.size() - 1, index.owned_first, [&](std::vector<NearEntry>& list, Row b) {
            for (Row first = candidates[b], last = candidates[b + 1]; first < last;
                 first += lane_count) {
                const unsigned count = std::min<unsigned>(lane_count, last - first);
                for (unsigned now = near_bits(&rows[first], count); now != 0; now &= now - 1) {
                    const Row p = first + static_cast<Row>(__builtin_ctz(now));
                    list.push_back({rows[p].sphere, rows[p].other, p, rows[p].law});
                }
            }
        });
    Table& near = world.table<typename Pairs::Near>();
    const std::size_t count = found.size(), padded = count == 0 ? 0 : count + 7;
    near.resize(padded);
    const auto entry = near.template column<NearPair>();
    found.lay_out([&](std::size_t slot, const NearEntry& e) { entry[slot] = e; });
    for (std::size_t k = count; k < padded; ++k)
        entry[k] = entry[0]; // lanes past the end read valid rows
    index.centred = world.table<Bodies>().has<SphereInertia>();
    index.awake.clear();
    index.look.clear();
    detail::divide_into_chunks<Pairs>(world);
}

/// `gap`: lower bound (m) of the gap between an enlarged sphere and the boundary.
template <class Pairs, class Gap>
void list_near_boundary(World& world, Gap&& gap, double beyond = 0) {
    const auto skin = world.column<Bodies, InnerSkin>();
    list_near<Pairs>(world, [&](const PairRowNumbers* rows, unsigned count) {
        unsigned now = 0;
        for (unsigned k = 0; k < count; ++k)
            now |= (gap(rows[k]) < skin[rows[k].partner_body] + beyond ? 1u : 0u) << k;
        return now;
    });
}

// only the list of spheres is long enough for lanes to pay off
void list_near_spheres(World& world) {
    const auto sphere_row = world.column<Spheres, EnlargedSphere>();
    list_near<SpherePairs>(world, [&](const PairRowNumbers* rows, unsigned count) {
        const auto row = [&](int q) -> const PairRowNumbers& {
            return rows[std::min(static_cast<unsigned>(q), count - 1)];
        };
        return near_lanes([&](int q) -> const SphereRow& { return sphere_row[row(q).sphere]; },
                          [&](int q) -> const SphereRow& { return sphere_row[row(q).other]; }) &
               ((1u << count) - 1);
    });
}

void list_near_planes(World& world) {
    const auto position = world.column<Bodies, Position>();
    const auto sphere_row = world.column<Spheres, EnlargedSphere>();
    const auto shape = world.column<Planes, LocalPlane>();
    list_near_boundary<PlanePairs>(world, [&](const PairRowNumbers& p) {
        const PlaneShape& plane = shape[p.other];
        return (detail::centre_of(sphere_row[p.sphere]) - position[p.partner_body] - plane.point)
                   .dot(plane.normal) -
               sphere_row[p.sphere].radius;
    });
}

void list_near_facets(World& world) {
    const detail::Poses<> poses(world);
    const auto sphere_row = world.column<Spheres, EnlargedSphere>();
    const auto shape = world.column<Facets, LocalFacet>();
    std::vector<detail::FlatPart> parts(shape.size());
    for (std::size_t e = 0; e < shape.size(); ++e) parts[e] = detail::FlatPart(shape[e].corners);
    const auto skin = world.column<Bodies, InnerSkin>();
    const double beyond = detail::reach_beyond_skin(world);
    const auto gap = [&](const PairRowNumbers& p) {
        const Pose host = poses[p.partner_body]; // in whose axes the facet is given
        const Vec3 x = host.orientation.conjugate() *
                       (detail::centre_of(sphere_row[p.sphere]) - host.position);
        return parts[p.other].gap(x, sphere_row[p.sphere].radius, skin[p.partner_body] + beyond);
    };
    list_near_boundary<FacetPairs>(world, gap, beyond);
}

void list_near_membrane(World& world) {
    const auto& membrane = world.resource<Membrane>();
    const auto sphere_row = world.column<Spheres, EnlargedSphere>();
    const double skin = world.column<Bodies, InnerSkin>()[membrane.body_row];
    const MembraneSurface surface(membrane, world.column<Elements, ElementRadius>().data());
    list_near_boundary<MembranePairs>(world, [&](const PairRowNumbers& p) {
        const Vec3 x = detail::centre_of(sphere_row[p.sphere]);
        const double out = x.dot(membrane.outward[p.other]);
        const auto sector = static_cast<int>(p.other);
        const double reach = sphere_row[p.sphere].radius + skin;
        if (out + reach <= surface.least_radius(sector, x.z()))
            return skin; // most pairs; their exact distance would be costly
        return surface.nearest(sector, out, x.z()).distance - sphere_row[p.sphere].radius;
    });
}

void list_near_triangles(World& world) {
    const auto sphere_row = world.column<Spheres, EnlargedSphere>();
    const auto skin = world.column<Bodies, InnerSkin>();
    const std::vector<detail::FlatPart> parts = detail::flat_parts_of_sleeve(world);
    list_near_boundary<MembranePairs>(world, [&](const PairRowNumbers& p) {
        return parts[p.other].gap(detail::centre_of(sphere_row[p.sphere]),
                                  sphere_row[p.sphere].radius, skin[p.partner_body]);
    });
}

// single spheres are all listed, in the rows of their bodies, so contacts need no lookup
void list_single_spheres(World& world) {
    const auto slot = world.column<Spheres, ListedSlot>();
    const auto ball = world.column<Spheres, LocalBall>();
    const auto runs = world.column<Bodies, SpheresOf>();
    Table& listed = world.table<Listed>();
    listed.resize(runs.size());
    const auto listed_position = listed.column<ListedPosition>();
    const auto listed_body = listed.column<ListedBody>();
    for_rows(runs.size(), [&](Row b) {
        runs[b].first_listed = b;
        runs[b].listed = runs[b].count;
        listed_body[b] = b;
        listed_position[b].radius = runs[b].count == 0 ? 0 : ball[runs[b].first].radius;
        if (runs[b].count > 0) slot[runs[b].first] = b;
    });
}

/// Marks the spheres of the near pairs by a slot of 0.
template <class Pairs>
void mark_spheres(World& world, std::span<Row> slot) {
    if (!world.has<Pairs>()) return;
    const auto entry = world.column<typename Pairs::Near, NearPair>();
    const auto mark = [&](Row sphere) {
        std::atomic_ref(slot[sphere]).store(0, std::memory_order_relaxed);
    };
    for_rows(world.resource<NearIndex<Pairs>>().size(), [&](Row k) {
        mark(entry[k].owner);
        if (std::is_same_v<Pairs, SpherePairs>) mark(entry[k].other);
    });
}

// gives every sphere on a short list a slot in Listed, body by body
void list_spheres(World& world) {
    if (world.table<Bodies>().has<SphereInertia>()) return list_single_spheres(world);
    const auto slot = world.column<Spheres, ListedSlot>();
    for_rows(slot.size(), [&](Row k) { slot[k] = no_row; });
    for_each_kind_of_pair([&]<class Pairs>() { mark_spheres<Pairs>(world, slot); });

    const auto runs = world.column<Bodies, SpheresOf>();
    std::vector<Row> first;
    detail::ChunkLists<Row> found;
    found.collect(runs.size(), first, [&](std::vector<Row>& list, Row b) {
        for (Row k = runs[b].first; k < runs[b].first + runs[b].count; ++k)
            if (slot[k] == 0) list.push_back(k);
    });
    const auto ball = world.column<Spheres, LocalBall>();
    Table& listed = world.table<Listed>();
    listed.resize(found.size());
    const auto listed_ball = listed.column<ListedBall>();
    const auto listed_body = listed.column<ListedBody>();
    found.lay_out([&](std::size_t index, Row sphere) {
        listed_ball[index] = ball[sphere];
        slot[sphere] = static_cast<Row>(index);
    });
    for_rows(runs.size(), [&](Row b) {
        runs[b].first_listed = first[b];
        runs[b].listed = first[b + 1] - first[b];
        for (Row k = first[b]; k < first[b + 1]; ++k) listed_body[k] = b;
    });
}

/// Replaces the rows of spheres in the near pairs by their slots.
template <class Pairs>
void use_slots(World& world) {
    if (!world.has<Pairs>()) return;
    const auto slot = world.column<Spheres, ListedSlot>();
    const auto entry = world.column<typename Pairs::Near, NearPair>();
    for_rows(entry.size(), [&](Row k) {
        entry[k].owner = slot[entry[k].owner];
        if (std::is_same_v<Pairs, SpherePairs>) entry[k].other = slot[entry[k].other];
    });
}

} // namespace

void prune_pairs(World& world) {
    world.table<Bodies>().leave_idle({});
    detail::locate_spheres<InnerSkin>(world);
    list_near_spheres(world);
    if (world.has<PlanePairs>()) list_near_planes(world);
    if (world.has<FacetPairs>()) list_near_facets(world);
    if (world.has<Elements>()) list_near_membrane(world);
    if (world.has<Triangles>()) list_near_triangles(world);
    detail::note_membrane_at_prune(world);
    detail::direct_forces(world);
    list_spheres(world);
    for_each_kind_of_pair([&]<class Pairs>() { use_slots<Pairs>(world); });
    detail::note_poses<PrunedAt, PrunedOrientation>(world);
    const auto displacement = world.column<Bodies, DisplacementBound>();
    for_rows(displacement.size(), [&](Row b) { displacement[b] = 0; });
    auto& state = world.resource<ListState>();
    state.used_up = false;
    state.last_prune = world.resource<Clock>().step;
    ++state.prunes;
}

} // namespace bris

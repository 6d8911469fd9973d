#include "components/boundary.hpp"
#include "components/membrane_surface.hpp"
#include "components/near_spheres.hpp"
#include "systems/broadphase/chunk_lists.hpp"
#include "systems/broadphase/force_targets.hpp"
#include "systems/broadphase/lists.hpp"

#include <algorithm>
#include <span>

namespace bris {

namespace {

// Lists the pairs of one kind within the inner skin, body by body, and clears the springs of the
// others. `near_bits` returns bits for up to lane_count candidates: set where the pair is near.
template <class Pairs, class Near>
void list_near(World& world, Near&& near_bits) {
    Table& pairs = world.table<Pairs>();
    const auto rows = pairs.column<PairRows>();
    const auto& candidates = world.resource<detail::Candidates<Pairs>>().first;
    SpringRow* spring = pairs.has<Spring>() ? pairs.column<Spring>().data() : nullptr;
    RollRow* roll = pairs.has<Roll>() ? pairs.column<Roll>().data() : nullptr;
    auto& index = world.resource<NearIndex<Pairs>>();
    detail::ChunkLists<NearEntry> found;
    found.collect(
        candidates.size() - 1, index.owned_first, [&](std::vector<NearEntry>& list, Row b) {
            for (Row first = candidates[b], last = candidates[b + 1]; first < last;
                 first += lane_count) {
                const unsigned count = std::min<unsigned>(lane_count, last - first),
                               now = near_bits(&rows[first], count);
                for (Row p = first; spring != nullptr && p < first + count; ++p)
                    if (((now >> (p - first)) & 1) == 0 && Spring::keep(spring[p])) {
                        spring[p] = {};
                        if (roll != nullptr) roll[p] = {};
                    }
                for (unsigned remaining = now; remaining != 0; remaining &= remaining - 1) {
                    const Row p = first + static_cast<Row>(__builtin_ctz(remaining));
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
    detail::divide_into_chunks(index);
}

template <class Pairs, class Gap>
void make_short_list(World& world, double skin, Gap&& gap) {
    list_near<Pairs>(world, [&](const PairRowNumbers* rows, unsigned count) {
        unsigned now = 0;
        for (unsigned k = 0; k < count; ++k) now |= (gap(rows[k]) < skin ? 1u : 0u) << k;
        return now;
    });
}

// only the list of spheres is long enough for lanes to pay off
void list_near_spheres(World& world, double skin) {
    const auto sphere_row = world.column<Spheres, SpherePosition>();
    list_near<SpherePairs>(world, [&](const PairRowNumbers* rows, unsigned count) {
        const auto row = [&](int q) -> const PairRowNumbers& {
            return rows[std::min(static_cast<unsigned>(q), count - 1)];
        };
        return near_lanes([&](int q) -> const SphereRow& { return sphere_row[row(q).sphere]; },
                          [&](int q) -> const SphereRow& { return sphere_row[row(q).other]; },
                          skin) &
               ((1u << count) - 1);
    });
}

template <class Pairs>
void mark_owners(World& world, std::span<Row> slot) {
    const auto entry = world.column<typename Pairs::Near, NearPair>();
    const std::size_t count = world.resource<NearIndex<Pairs>>().size();
    for (std::size_t k = 0; k < count; ++k) slot[entry[k].owner] = 0;
}

// single spheres are all listed, in the rows of their bodies, so contacts need no lookup
void list_single_spheres(World& world) {
    const auto slot = world.column<Spheres, ListedSlot>();
    const auto ball = world.column<Spheres, LocalBall>();
    const auto runs = world.column<Bodies, SpheresOf>();
    Table& listed = world.table<Listed>();
    listed.resize(runs.size());
    for (Row b = 0; b < runs.size(); ++b) {
        runs[b].first_listed = b;
        runs[b].listed = runs[b].count;
        listed.column<ListedBody>()[b] = b;
        if (runs[b].count == 0) continue;
        listed.column<ListedBall>()[b] = ball[runs[b].first];
        slot[runs[b].first] = b;
    }
}

// gives every sphere on a short list a slot in Listed, body by body
void list_spheres(World& world) {
    if (world.table<Bodies>().has<SphereInertia>()) return list_single_spheres(world);
    const auto slot = world.column<Spheres, ListedSlot>();
    std::fill(slot.begin(), slot.end(), no_row);
    const auto entry = world.column<NearSpheres, NearPair>();
    const std::size_t count = world.resource<NearIndex<SpherePairs>>().size();
    for (std::size_t k = 0; k < count; ++k) slot[entry[k].owner] = slot[entry[k].other] = 0;
    if (world.has<PlanePairs>()) mark_owners<PlanePairs>(world, slot);
    if (world.has<FacetPairs>()) mark_owners<FacetPairs>(world, slot);
    if (world.has<MembranePairs>()) mark_owners<MembranePairs>(world, slot);

    const auto ball = world.column<Spheres, LocalBall>();
    Table& listed = world.table<Listed>();
    listed.resize(static_cast<std::size_t>(std::count(slot.begin(), slot.end(), Row{0})));
    const auto listed_ball = listed.column<ListedBall>();
    const auto listed_body = listed.column<ListedBody>();
    const auto runs = world.column<Bodies, SpheresOf>();
    Row next = 0;
    for (Row b = 0; b < runs.size(); ++b) {
        SphereRun& run = runs[b];
        run.first_listed = next;
        for (Row k = run.first; k < run.first + run.count; ++k)
            if (slot[k] == 0) {
                listed_ball[next] = ball[k];
                listed_body[next] = b;
                slot[k] = next++;
            }
        run.listed = next - run.first_listed;
    }
}

template <class Pairs>
void use_slots(World& world, bool partners_too) {
    const auto slot = world.column<Spheres, ListedSlot>();
    for (NearEntry& e : world.column<typename Pairs::Near, NearPair>()) {
        e.owner = slot[e.owner];
        if (partners_too) e.other = slot[e.other];
    }
}

} // namespace

void prune_pairs(World& world) {
    auto& state = world.resource<ListState>();
    const double skin = world.resource<ListSettings>().inner_skin;
    Table& bodies = world.table<Bodies>();
    const auto sphere_row = world.column<Spheres, SpherePosition>();
    bodies.leave_idle({});
    const detail::ListDistances within = detail::list_distances(world, skin);
    list_near_spheres(world, within.spheres_and_planes);
    const auto position = bodies.column<Position>();
    if (world.has<PlanePairs>()) {
        const auto shape = world.column<Planes, LocalPlane>();
        make_short_list<PlanePairs>(world, within.spheres_and_planes, [&](const PairRowNumbers& p) {
            const PlaneShape& plane = shape[p.other];
            return (detail::centre_of(sphere_row[p.sphere]) - position[p.partner_body] -
                    plane.point)
                       .dot(plane.normal) -
                   sphere_row[p.sphere].radius;
        });
    }
    if (world.has<FacetPairs>()) {
        const auto shape = world.column<Facets, LocalFacet>();
        std::vector<Eigen::AlignedBox3d> boxes(shape.size());
        std::vector<Vec3> normal(shape.size());
        for (std::size_t e = 0; e < shape.size(); ++e) {
            const auto& c = shape[e].corners;
            for (const Vec3& corner : c) boxes[e].extend(Eigen::Vector3d(corner));
            normal[e] = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
        }
        // the distances to the facet's box and to its plane are both lower bounds
        make_short_list<FacetPairs>(world, within.facets, [&](const PairRowNumbers& p) {
            const Vec3 x = detail::centre_of(sphere_row[p.sphere]) - position[p.partner_body];
            const double height = std::abs((x - shape[p.other].corners[0]).dot(normal[p.other]));
            if (height - sphere_row[p.sphere].radius >= within.facets) return within.facets;
            return boxes[p.other].exteriorDistance(Eigen::Vector3d(x)) -
                   sphere_row[p.sphere].radius;
        });
    }
    if (world.has<MembranePairs>()) {
        const auto& membrane = world.resource<Membrane>();
        const MembraneSurface surface(membrane, world.column<Elements, ElementRadius>().data());
        make_short_list<MembranePairs>(world, skin, [&](const PairRowNumbers& p) {
            const Vec3 x = detail::centre_of(sphere_row[p.sphere]);
            const double out = x.dot(membrane.outward[p.other]);
            const auto sector = static_cast<int>(p.other);
            const double reach = sphere_row[p.sphere].radius + skin;
            if (out + reach <= surface.least_radius(sector, x.z()))
                return skin; // most pairs; their exact distance would be costly
            return surface.nearest(sector, out, x.z()).distance - sphere_row[p.sphere].radius;
        });
        std::ranges::copy(world.column<Elements, ElementRadius>(),
                          world.column<Elements, PrunedRadius>().begin());
    }
    detail::direct_forces(world);
    list_spheres(world);
    use_slots<SpherePairs>(world, true);
    if (world.has<PlanePairs>()) use_slots<PlanePairs>(world, false);
    if (world.has<FacetPairs>()) use_slots<FacetPairs>(world, false);
    if (world.has<MembranePairs>()) use_slots<MembranePairs>(world, false);

    const auto pruned = bodies.column<PrunedAt>();
    const auto displacement = bodies.column<DisplacementBound>();
    const Quat* q = bodies.has<Orientation>() ? bodies.column<Orientation>().data() : nullptr;
    for (Row b = 0; b < bodies.size(); ++b) {
        pruned[b] = {position[b], q != nullptr ? q[b] : Quat(Quat::Identity())};
        displacement[b] = 0;
    }
    state.last_prune = world.resource<Clock>().step;
    ++state.prunes;
}

} // namespace bris

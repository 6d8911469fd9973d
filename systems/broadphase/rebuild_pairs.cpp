#include "components/boundary.hpp"
#include "components/force_sums.hpp"
#include "components/laws/partial_step.hpp"
#include "components/material.hpp"
#include "components/membrane.hpp"
#include "engine/lane_math.hpp"
#include "engine/ordering.hpp"
#include "engine/parallel.hpp"
#include "systems/broadphase/lists.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace bris {

namespace {

// the spheres of a body are contiguous, and the runs are in the order of the bodies' rows
void find_runs(World& world) {
    Table &bodies = world.table<Bodies>(), &spheres = world.table<Spheres>();
    const auto run = bodies.column<SpheresOf>();
    const auto parent = spheres.column<ParentId>();
    const auto row_of = rows_by_id(bodies.column<BodyId>());
    for (SphereRun& r : run) r = {};
    for (Row s = 0; s < spheres.size(); ++s) {
        SphereRun& r = run[row_of[parent[s]]];
        if (r.count++ == 0) r.first = s;
    }
    if (world.has<Planes>()) {
        const auto host = world.column<Planes, HostId>();
        const auto row = world.column<Planes, HostRow>();
        for (std::size_t i = 0; i < host.size(); ++i) row[i] = row_of[host[i]];
    }
    if (world.has<Facets>()) {
        const auto host = world.column<Facets, HostId>();
        const auto row = world.column<Facets, HostRow>();
        for (std::size_t i = 0; i < host.size(); ++i) row[i] = row_of[host[i]];
    }
    if (world.has<Elements>())
        world.resource<Membrane>().body_row = row_of[world.resource<Membrane>().body];
}

// sorts bodies along a Morton curve, and spheres with them; driven bodies too, because they are few
void sort_rows(World& world) {
    Table &bodies = world.table<Bodies>(), &spheres = world.table<Spheres>();
    const auto radius = bodies.column<BoundingRadius>();
    double mean = 0;
    for (const double r : radius) mean += r;
    if (!(mean > 0)) return;
    const auto order = morton_order(bodies.column<Position>(), bodies.column<BodyId>(),
                                    2 * mean / static_cast<double>(bodies.size()));
    const auto run = bodies.column<SpheresOf>();
    std::vector<Row> sphere_order;
    sphere_order.reserve(spheres.size());
    for (const Row b : order)
        for (Row k = run[b].first; k < run[b].first + run[b].count; ++k) sphere_order.push_back(k);
    bodies.permute(order);
    spheres.permute(sphere_order);
}

/// Poses of all bodies; single spheres have no orientation.
class Poses {
public:
    explicit Poses(const Table& bodies)
        : position_(bodies.column<Position>().data()),
          orientation_(bodies.has<Orientation>() ? bodies.column<Orientation>().data() : nullptr) {}
    Pose operator[](Row b) const {
        return {position_[b], orientation_ != nullptr ? orientation_[b] : Quat(Quat::Identity())};
    }

private:
    const Vec3* position_;
    const Quat* orientation_;
};

template <class Since>
double displacement_of_membrane(const World& world) {
    if (!world.has<Elements>()) return 0;
    const auto radius = world.column<Elements, ElementRadius>();
    const auto since = world.column<Elements, Since>();
    double largest = 0;
    for (std::size_t e = 0; e < radius.size(); ++e)
        largest = std::max(largest, std::abs(radius[e] - since[e]));
    return largest;
}

double largest_displacement(const World& world) {
    const Table& bodies = world.table<Bodies>();
    const auto from = bodies.column<RebuiltAt>();
    const auto radius = bodies.column<BoundingRadius>();
    const Poses poses(bodies);
    double largest = 0;
    for (Row b = 0; b < bodies.size(); ++b) {
        const Pose now = poses[b];
        largest = std::max(largest,
                           displacement_bound(now.position, now.orientation, from[b], radius[b]));
    }
    return std::max(largest, displacement_of_membrane<RebuiltRadius>(world));
}

void choose_skins(World& world, ListSettings& settings) {
    if (settings.outer_skin > 0 && settings.inner_skin > 0 && settings.largest_skin > 0) return;
    const Table& bodies = world.table<Bodies>();
    const auto radius = bodies.column<BoundingRadius>();
    const auto run = bodies.column<SpheresOf>();
    double sum = 0, count = 0;
    for (Row b = 0; b < bodies.size(); ++b)
        if (run[b].count > 0) {
            sum += radius[b];
            ++count;
        }
    const double mean = count > 0 ? sum / count : 1;
    // with a larger skin the number of candidates grows faster than the time for which they serve;
    // for clumps this limit is lower, because their bounding spheres contain many spheres
    const double most = world.table<Bodies>().has<SphereInertia>() ? 1.2 : 0.3;
    if (!(settings.largest_skin > 0))
        settings.largest_skin = std::max(most * mean, settings.outer_skin);
    if (!(settings.inner_skin > 0)) settings.inner_skin = 0.02 * mean;
    if (!(settings.outer_skin > 0)) settings.outer_skin = 5 * settings.inner_skin;
}

/// Factor by which to change a skin. Making its list costs a/skin per step and carrying the list
/// costs b*skin; the sum is least where the two are equal. Bounded, because the counts scatter from
/// one list to the next.
double change_of_skin(double making, double carrying) {
    constexpr double most = 1.5;
    if (!(carrying > 0)) return making > 0 ? most : 1;
    return std::clamp(std::sqrt(making / carrying), 1 / most, most);
}

// The skins are adapted to counts of work in units of the test of one near pair, measured on beds
// of spheres and of clumps. Any skin gives the same bits.

void tune_inner_skin(const World& world, ListSettings& settings, const ListState& state) {
    const auto steps = static_cast<double>(world.resource<Clock>().step - state.last_prune);
    const auto& index = world.resource<NearIndex<SpherePairs>>();
    if (!settings.tune || state.prunes == 0 || steps == 0 || index.size() == 0) return;
    std::size_t touching = 0;
    for (const std::uint8_t flags : index.touching)
        touching += static_cast<std::size_t>(std::popcount(flags));
    const auto pairs = static_cast<double>(world.table<SpherePairs>().size());
    const auto spheres = static_cast<double>(world.table<Listed>().size());
    const double making = (8 * pairs + 10 * spheres) / steps;
    const double carrying =
        3 * static_cast<double>(index.size() - std::min(touching, index.size()));
    settings.inner_skin =
        std::min(settings.inner_skin * change_of_skin(making, carrying), settings.largest_skin / 2);
    settings.outer_skin =
        std::clamp(settings.outer_skin, 2 * settings.inner_skin, settings.largest_skin);
}

/// To be called when the candidates are no longer complete.
void tune_outer_skin(const World& world, ListSettings& settings, const ListState& state) {
    const auto near = world.resource<NearIndex<SpherePairs>>().size();
    const auto prunes = static_cast<double>(state.prunes - state.prunes_at_rebuild);
    if (!settings.tune || near == 0 || prunes == 0) return;
    const auto pairs = static_cast<double>(world.table<SpherePairs>().size());
    const double rebuilding = 60 * pairs, pruning = 8 * (pairs - static_cast<double>(near)) *
                                                    prunes; // while the candidates served
    settings.outer_skin = std::clamp(settings.outer_skin * change_of_skin(rebuilding, pruning),
                                     2 * settings.inner_skin, settings.largest_skin);
}

/// Notes what the units of force sums are chosen from.
void note_bodies(World& world) {
    const Table& bodies = world.table<Bodies>();
    const auto radius = bodies.column<BoundingRadius>();
    const auto material = bodies.column<MaterialOf>();
    const auto spheres = bodies.column<SpheresOf>();
    auto& grid = world.resource<ForceGrid>();
    const std::size_t materials = world.resource<Materials>().list.size();
    grid.largest_radius = 0;
    grid.grains.assign(materials, 0);
    grid.hosts.assign(materials, 0);
    for (Row b = 0; b < bodies.size(); ++b) {
        const bool grain = spheres[b].count > 0;
        ++(grain ? grid.grains : grid.hosts)[material[b]];
        if (grain) grid.largest_radius = std::max(grid.largest_radius, radius[b]);
    }
}

/// Upper bound (m) of the gap of contacts that have ended in the last step and are still corrected.
double largest_corrected_gap(const World& world) {
    const Table& bodies = world.table<Bodies>();
    const auto velocity = bodies.column<Velocity>(), omega = bodies.column<StepAngularVelocity>();
    const auto radius = bodies.column<BoundingRadius>();
    double fastest = 0;
    for (Row b = 0; b < bodies.size(); ++b)
        fastest = std::max(fastest, velocity[b].norm() + omega[b].norm() * radius[b]);
    return (1 + 1e-6) * CorrectionOfEnd::largest_gap * 2 * fastest * world.resource<Clock>().dt;
}

/// Brings SpherePosition up to date.
void locate_spheres(World& world) {
    const Table& bodies = world.table<Bodies>();
    Table& spheres = world.table<Spheres>();
    const auto run = bodies.column<SpheresOf>();
    const Poses poses(bodies);
    const auto ball = spheres.column<LocalBall>();
    const auto sphere_row = spheres.column<SpherePosition>();
    for_chunks(bodies.size(), 256, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (auto b = static_cast<Row>(begin); b < end; ++b) {
            const Pose pose = poses[b];
            const Mat3 axes = pose.orientation.toRotationMatrix();
            for (Row k = run[b].first; k < run[b].first + run[b].count; ++k) {
                const Vec3 x = pose.position + axes * ball[k].centre;
                sphere_row[k] = {x.x(), x.y(), x.z(), ball[k].radius};
            }
        }
    });
}

} // namespace

bool lists_are_due(const World& world) {
    if (world.resource<ListState>().stale) return true;
    const auto displacement = world.column<Bodies, DisplacementBound>();
    Lane most{};
    for_lane_rows(0, static_cast<Row>(displacement.size()),
                  [&](LaneRows rows) { most = max(load(displacement.data(), rows), most); });
    double largest = displacement_of_membrane<PrunedRadius>(world);
    for (std::size_t k = 0; k < lane_count; ++k) largest = std::max(largest, most[k]);
    return !(2 * largest <= world.resource<ListSettings>().inner_skin);
}

bool positions_are_due(const World& world) {
    return world.resource<ListState>().velocities_changed || lists_are_due(world);
}
void note_positions(World& world) { world.resource<ListState>().velocities_changed = false; }
void show_velocities(World& world) { world.resource<ListState>().velocities_changed = true; }

detail::ListDistances detail::list_distances(const World& world, double skin) {
    const LawTraits& law = traits(world.resource<ContactLaw>().law);
    if (law.springs && law.dashpots) skin = std::max(skin, largest_corrected_gap(world));
    if (!law.reaches) return {skin, skin};
    double radius = 0;
    for (const Ball& ball : world.column<Spheres, LocalBall>())
        radius = std::max(radius, ball.radius);
    // a pair at its very reach must not be lost to rounding
    const double reach = (1 + 1e-6) * largest_reach(world.resource<ContactLaw>().law,
                                                    world.resource<Materials>(), radius);
    return {std::max(skin, reach), skin + reach};
}

void rebuild_pairs(World& world) {
    auto& state = world.resource<ListState>();
    auto& settings = world.resource<ListSettings>();
    if (!state.stale) {
        tune_inner_skin(world, settings, state);
        const double gone = 2 * largest_displacement(world);
        if (gone + settings.inner_skin <= state.candidate_skin)
            return locate_spheres(world); // the candidates are still complete
        tune_outer_skin(world, settings, state);
    }
    find_runs(world);
    choose_skins(world, settings);
    if (settings.sort_every > 0 && state.rebuilds % settings.sort_every == 0) {
        sort_rows(world);
        find_runs(world);
        ++state.sorts;
    }
    Table& bodies = world.table<Bodies>();
    const auto rebuilt = bodies.column<RebuiltAt>();
    const Poses poses(bodies);
    for (Row b = 0; b < bodies.size(); ++b) rebuilt[b] = poses[b];
    note_bodies(world);

    locate_spheres(world);
    const detail::ListDistances within = detail::list_distances(world, settings.outer_skin);
    detail::find_sphere_pairs(world, within.spheres_and_planes);
    if (world.has<PlanePairs>()) detail::find_plane_pairs(world, within.spheres_and_planes);
    if (world.has<FacetPairs>()) detail::find_facet_pairs(world, within.facets);
    if (world.has<MembranePairs>()) {
        detail::find_membrane_pairs(world, settings.outer_skin);
        std::ranges::copy(world.column<Elements, ElementRadius>(),
                          world.column<Elements, RebuiltRadius>().begin());
    }
    state.stale = false;
    state.candidate_skin = settings.outer_skin;
    state.last_rebuild = world.resource<Clock>().step;
    state.prunes_at_rebuild = state.prunes;
    ++state.rebuilds;
}

void invalidate_lists(World& world) { world.resource<ListState>().stale = true; }

void forget_lists(World& world) {
    invalidate_lists(world);
    for_each_kind_of_pair([&]<class Pairs>() {
        if (world.has<Pairs>()) world.resource<NearIndex<Pairs>>() = {};
    });
    find_runs(world);
}

namespace {

template <class Pairs>
void add_pair_tables(World& world, LawName law) {
    Table& pairs = world.table<Pairs>();
    pairs.add<PairKey>();
    pairs.add<PairRows>();
    if (has_springs(law)) pairs.add<Spring>();
    if (has_rolling(law)) pairs.add<Roll>();
    Table& near = world.table<typename Pairs::Near>();
    near.add<NearPair>();
    near.add<PartnerSum>();
    near.add<PairForce>();
    world.add_resource<NearIndex<Pairs>>();
    world.add_resource<detail::Candidates<Pairs>>();
}

} // namespace

void add_lists(World& world, LawName law, ListSettings settings) {
    Table& bodies = world.table<Bodies>();
    bodies.add<SpheresOf>();
    bodies.add<DisplacementBound>();
    bodies.add<PrunedAt>();
    bodies.add<RebuiltAt>();
    bodies.add<ContactSum>();
    bodies.add<HaloOf>();
    bodies.add<Force>();
    bodies.add<Torque>();
    bodies.add<RigidMotion>();
    bodies.add<CentreOf>();
    if (has_dashpots(law)) bodies.add<Kick>();
    world.table<Spheres>().add<ListedSlot>();
    world.table<Spheres>().add<SpherePosition>();
    Table& listed = world.table<Listed>();
    listed.add<ListedBall>();
    listed.add<ListedBody>();
    listed.add<ListedPosition>();
    add_pair_tables<SpherePairs>(world, law);
    if (world.has<Planes>()) add_pair_tables<PlanePairs>(world, law);
    if (world.has<Facets>()) add_pair_tables<FacetPairs>(world, law);
    if (world.has<Elements>()) {
        add_pair_tables<MembranePairs>(world,
                                       LawName::linear_frictionless); // for any law between grains
        world.table<NearMembrane>().add<FootOf>();
        world.add_resource<MembraneBands>();
        world.add_resource<ElementSums>();
    }
    if (world.resource<Materials>().policy.patch == PatchStiffness::shared) {
        world.table<NearSpheres>().add<PatchShare>();
        if (world.has<Planes>()) world.table<NearPlanes>().add<PatchShare>();
    }
    world.add_resource(settings);
    world.add_resource(ContactLaw{law});
    world.add_resource<ListState>();
    world.add_resource<ContactHalo>();
    world.add_resource<ForceGrid>();
    world.add_resource<Observation>();
}

} // namespace bris

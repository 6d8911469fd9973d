#include "systems/broadphase/skins.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/law.hpp"
#include "components/laws/partial_step.hpp"
#include "components/membrane.hpp"
#include "components/pair.hpp"
#include "components/slab.hpp"
#include "components/sleeve.hpp"
#include "components/sphere.hpp"
#include "engine/clock.hpp"
#include "engine/parallel.hpp"
#include "engine/ranks.hpp"
#include "systems/broadphase/sphere_rows.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <span>
#include <utility>

namespace bris::detail {

namespace {

constexpr std::size_t bodies_per_chunk = 1024;

/// Sum of value(row) over all bodies, added in the same order on any number of threads.
template <class Value>
double sum_over_bodies(std::size_t bodies, Value&& value) {
    std::vector<double> sums((bodies + bodies_per_chunk - 1) / bodies_per_chunk);
    for_chunks(bodies, bodies_per_chunk,
               [&](std::size_t chunk, std::size_t first, std::size_t last) {
                   for (auto b = static_cast<Row>(first); b < last; ++b) sums[chunk] += value(b);
               });
    double sum = 0;
    for (const double s : sums) sum += s;
    return sum;
}

/// Largest of value(row), which is not negative, of all rows.
template <class Value>
double largest_of_rows(std::size_t rows, Value&& value) {
    std::vector<double> most((rows + bodies_per_chunk - 1) / bodies_per_chunk);
    for_chunks(rows, bodies_per_chunk, [&](std::size_t chunk, std::size_t first, std::size_t last) {
        for (auto b = static_cast<Row>(first); b < last; ++b)
            most[chunk] = std::max(most[chunk], value(b));
    });
    return most.empty() ? 0 : *std::ranges::max_element(most);
}

template <class Since, class NodeSince>
double membrane_moved(const World& world) {
    double largest = 0;
    if (world.has<Elements>()) {
        const auto radius = world.column<Elements, ElementRadius>();
        const auto since = world.column<Elements, Since>();
        for (std::size_t e = 0; e < radius.size(); ++e)
            largest = std::max(largest, std::abs(radius[e] - since[e]));
    }
    if (world.has<Nodes>()) {
        const auto position = world.column<Nodes, NodePosition>();
        const auto since = world.column<Nodes, NodeSince>();
        for (std::size_t n = 0; n < position.size(); ++n)
            largest = std::max(largest, (position[n] - since[n]).norm());
    }
    return largest;
}

template <class Since, class NodeSince>
void note_membrane(World& world) {
    if (world.has<Elements>())
        std::ranges::copy(world.column<Elements, ElementRadius>(),
                          world.column<Elements, Since>().begin());
    if (world.has<Nodes>())
        std::ranges::copy(world.column<Nodes, NodePosition>(),
                          world.column<Nodes, NodeSince>().begin());
}

/// Sums over all ranks where a world is divided: all ranks choose the same skins.
void sum_over_ranks(const World& world, std::span<double> sums) {
    if (world.has_resource<Slab>()) Ranks::sum(sums);
}

/// Mean of value(row) over the bodies with spheres; 0 if there is none.
template <class Value>
double mean_of_grains(const World& world, Value&& value) {
    const Table& bodies = world.table<Bodies>();
    const auto spheres = bodies.column<SpheresOf>();
    const Ghosts ghosts(bodies); // count on their own ranks
    const auto over_grains = [&](auto&& of) {
        return sum_over_bodies(
            bodies.size(), [&](Row b) { return spheres[b].count > 0 && !ghosts[b] ? of(b) : 0.0; });
    };
    std::array<double, 2> sums{over_grains([](Row) { return 1.0; }), over_grains(value)};
    sum_over_ranks(world, sums);
    return sums[0] > 0 ? sums[1] / sums[0] : 0;
}

void choose_mean_skins(const World& world, ListSettings& settings) {
    if (settings.outer_skin > 0 && settings.inner_skin > 0 && settings.largest_skin > 0) return;
    const Table& bodies = world.table<Bodies>();
    const auto radius = bodies.column<BoundingRadius>();
    const double of_grains = mean_of_grains(world, [&](Row b) { return radius[b]; }),
                 mean = of_grains > 0 ? of_grains : 1;
    // with a larger skin the number of candidates grows faster than the time for which they serve;
    // for clumps this limit is lower, because their bounding spheres contain many spheres
    const double most = bodies.has<SphereInertia>() ? 1.2 : 0.3;
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
// of spheres and of clumps.

/// Counts of the work of the lists.
struct Counts {
    double pairs = 0, near = 0, touching = 0, listed = 0, spheres = 0;
};

Counts counts_of_lists(const World& world) {
    const auto& index = world.resource<NearIndex<SpherePairs>>();
    std::size_t touching = 0;
    for (const std::uint8_t flags : index.touching)
        touching += static_cast<std::size_t>(std::popcount(flags));
    std::array<std::size_t, 5> counts{world.table<SpherePairs>().size(), index.size(),
                                      std::min(touching, index.size()),
                                      world.table<Listed>().size(), world.table<Spheres>().size()};
    std::array<double, 5> sums{};
    std::ranges::copy(counts, sums.begin());
    sum_over_ranks(world, sums);
    return {sums[0], sums[1], sums[2], sums[3], sums[4]};
}

/// Number of steps for which the short lists have served, when the next ones are chosen: at the
/// beginning of a step or, where a world is divided, at the end of the last one.
double steps_served(const World& world) {
    const std::uint64_t begun =
        world.resource<Clock>().step - world.resource<ListState>().last_prune;
    return static_cast<double>(begun + (world.has_resource<Slab>() ? 1 : 0));
}

void tune_inner_skin(const World& world, ListSettings& settings, const ListState& state) {
    const double steps = steps_served(world);
    if (!settings.tune || state.prunes == 0 || steps == 0) return;
    const Counts count = counts_of_lists(world);
    if (count.near == 0) return;
    const double making = (8 * count.pairs + 10 * count.listed) / steps;
    const double carrying = 3 * (count.near - count.touching);
    settings.inner_skin =
        std::min(settings.inner_skin * change_of_skin(making, carrying), settings.largest_skin / 2);
    settings.outer_skin =
        std::clamp(settings.outer_skin, 2 * settings.inner_skin, settings.largest_skin);
}

/// To be called when the candidates are no longer complete.
void tune_outer_skin(const World& world, ListSettings& settings, const ListState& state) {
    const auto prunes = static_cast<double>(state.prunes - state.prunes_at_rebuild);
    if (!settings.tune || prunes == 0) return;
    const Counts count = counts_of_lists(world);
    if (count.near == 0) return;
    // what a rebuild costs per pair does not count, because the number of pairs grows with the skin
    const double rebuilding = 130 * count.spheres,
                 pruning = 8 * (count.pairs - count.near) * prunes; // while the candidates served
    settings.outer_skin = std::clamp(settings.outer_skin * change_of_skin(rebuilding, pruning),
                                     2 * settings.inner_skin, settings.largest_skin);
}

/// Updates the surface speeds of all bodies from their displacements since the last prune.
void measure_speeds(World& world) {
    const ListState& state = world.resource<ListState>();
    const double steps = steps_served(world);
    if (steps == 0 || state.prunes == 0) return;
    Table& bodies = world.table<Bodies>();
    const auto displacement = bodies.column<DisplacementBound>();
    const auto speed = bodies.column<SurfaceSpeed>();
    const auto measure = [&](Row b, double gone) {
        const double now = gone / steps;
        speed[b] = now < 1e300 ? std::max(now, 0.5 * speed[b]) : 0; // the guard stops the run
    };
    for_rows(bodies.size(), [&](Row b) { measure(b, displacement[b]); });
    if (world.has_resource<Membrane>())
        measure(world.resource<Membrane>().body_row, membrane_moved_since_prune(world));
}

/// Least skin (m) of a body: half the gap within which two bodies must be listed although they are
/// apart, for the correction or the energy budget of a contact that has just ended, or by the reach
/// of the law.
double least_skin(const World& world) {
    const LawTraits& law = traits(world.resource<ContactLaw>().law);
    const Table& bodies = world.table<Bodies>();
    double skin = 0.5 * reach_beyond_skin(world);
    const bool ends_count =
        law.dashpots || bodies.has<FrictionWork>(); // also for the energy budget
    if (law.springs && ends_count) {
        const auto velocity = bodies.column<Velocity>(),
                   omega = bodies.column<StepAngularVelocity>();
        const auto radius = bodies.column<BoundingRadius>();
        const double fastest = largest_of_rows(
            bodies.size(), [&](Row b) { return velocity[b].norm() + omega[b].norm() * radius[b]; });
        skin = std::max(skin, (1 + 1e-6) * CorrectionOfEnd::largest_gap * fastest *
                                  world.resource<Clock>().dt);
    }
    return world.has_resource<Slab>() ? Ranks::largest(skin) : skin;
}

/// Skins that new lists should have. A body of mean speed has half the skin of a pair.
class WantedSkins {
public:
    WantedSkins(const World& world, double least)
        : speed_(world.column<Bodies, SurfaceSpeed>()),
          mean_(mean_of_grains(world, [&](Row b) { return speed_[b]; })),
          settings_(world.resource<ListSettings>()), least_(least) {}
    double inner(Row b) const { return skin(b, settings_.inner_skin, settings_.largest_skin / 2); }
    double outer(Row b) const {
        return std::max(skin(b, settings_.outer_skin, settings_.largest_skin), inner(b));
    }

private:
    double skin(Row b, double of_pair, double most) const {
        // some more than in proportion for slow bodies, because they may become faster
        const double share = mean_ > 0 ? (speed_[b] + 2 * mean_) / (3 * mean_) : 1;
        return std::max(std::min(share * of_pair / 2, std::max(of_pair / 2, most)), least_);
    }
    std::span<const double> speed_;
    double mean_;
    const ListSettings& settings_;
    double least_;
};

/// Upper bound (m) on the displacements of bodies since the last rebuild.
class SinceRebuild {
public:
    explicit SinceRebuild(const World& world)
        : now_(world), from_(world), radius_(world.column<Bodies, BoundingRadius>()) {
        if (!world.has_resource<Membrane>()) return;
        membrane_ = world.resource<Membrane>().body_row;
        of_membrane_ = membrane_moved_since_rebuild(world);
    }
    double operator[](Row b) const {
        if (b == membrane_) return of_membrane_;
        const Pose now = now_[b];
        return displacement_bound(now.position, now.orientation, from_[b], radius_[b]);
    }

private:
    Poses<> now_;
    Poses<RebuiltAt, RebuiltOrientation> from_;
    std::span<const double> radius_;
    Row membrane_ = no_row;
    double of_membrane_ = 0;
};

} // namespace

double membrane_moved_since_prune(const World& world) {
    return membrane_moved<PrunedRadius, PrunedNode>(world);
}
double membrane_moved_since_rebuild(const World& world) {
    return membrane_moved<RebuiltRadius, RebuiltNode>(world);
}
void note_membrane_at_prune(World& world) { note_membrane<PrunedRadius, PrunedNode>(world); }
void note_membrane_at_rebuild(World& world) { note_membrane<RebuiltRadius, RebuiltNode>(world); }

double reach_beyond_skin(const World& world) {
    const LawTraits& law = traits(world.resource<ContactLaw>().law);
    if (!law.reaches) return 0;
    const auto ball = world.column<Spheres, LocalBall>();
    const double radius = largest_of_rows(ball.size(), [&](Row k) { return ball[k].radius; });
    // a pair at its very reach must not be lost to rounding
    return (1 + 1e-6) *
           largest_reach(world.resource<ContactLaw>().law, world.resource<Materials>(), radius);
}

bool choose_inner_skins(World& world) {
    auto& settings = world.resource<ListSettings>();
    tune_inner_skin(world, settings, world.resource<ListState>());
    measure_speeds(world);
    Table& bodies = world.table<Bodies>();
    const auto inner = bodies.column<InnerSkin>(), outer = bodies.column<OuterSkin>();
    const double least = least_skin(world);
    const WantedSkins wanted(world, least);
    const SinceRebuild since(world);
    std::atomic<bool> complete = true;
    for_rows(bodies.size(), [&](Row b) {
        const double left = outer[b] - since[b], want = wanted.inner(b);
        inner[b] = std::min(want, left);
        if (!(left >= std::max(0.5 * want, least))) complete = false;
    });
    if (world.has_resource<Slab>()) complete = !Ranks::any(!complete);
    if (complete) return true;
    auto& state = world.resource<ListState>();
    if (!std::exchange(state.brief, false)) tune_outer_skin(world, settings, state);
    return false;
}

void choose_outer_skins(World& world) {
    choose_mean_skins(world, world.resource<ListSettings>());
    const auto outer = world.column<Bodies, OuterSkin>();
    const WantedSkins wanted(world, least_skin(world));
    for_rows(outer.size(), [&](Row b) { outer[b] = wanted.outer(b); });
}

void choose_skins(World& world) {
    Table& bodies = world.table<Bodies>();
    if (!bodies.has<Ghost>()) choose_outer_skins(world);
    const auto inner = bodies.column<InnerSkin>(), outer = bodies.column<OuterSkin>();
    const WantedSkins wanted(world, least_skin(world));
    const bool brief = world.resource<ListState>().brief;
    for_rows(bodies.size(), [&](Row b) {
        inner[b] = std::min(wanted.inner(b), outer[b]);
        if (brief) outer[b] = inner[b];
    });
}

} // namespace bris::detail

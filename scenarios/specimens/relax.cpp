#include "scenarios/specimens/relax.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "components/pair.hpp"
#include "components/platen.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "engine/random.hpp"
#include "engine/report.hpp"
#include "engine/simulation.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/output/quantities.hpp"
#include "systems/steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace bris {

namespace {

constexpr std::uint64_t block = 5; // steps between inspections
constexpr std::uint64_t parting_stream = 5001;
constexpr double nudge = 1e-3; // initial separation of coincident bodies, relative to the radius

bool is_free(const Table& bodies, Row b) {
    return bodies.column<MotionOf>()[b] == static_cast<std::uint32_t>(Motion::free);
}

/// Removes all loads except contacts and all motion except that of free bodies, which start at
/// rest.
void silence(World& world, double damping) {
    if (world.has_resource<Gravity>()) world.resource<Gravity>().value.setZero();
    world.add_resource(LocalDamping{damping});
    auto& limits = world.resource<Limits>();
    const double infinite = std::numeric_limits<double>::infinity();
    limits.overlap = limits.speed = infinite; // overlapping bodies may enter a wall for a while
    limits.low = Vec3::Constant(-infinite);
    limits.high = Vec3::Constant(infinite);
    if (world.has_resource<Platen>()) {
        world.resource<Platen>().controlled = false;
        world.resource<Platen>().speed = 0;
    }
    if (world.has_resource<Membrane>()) {
        world.resource<Membrane>().active = false;
        std::ranges::fill(world.column<Elements, ElementSpeed>(), 0.0);
    }
    const auto stop = [&]<class Column>() {
        for (auto& value : world.column<Bodies, Column>()) value.setZero();
    };
    stop.template operator()<Velocity>();
    stop.template operator()<Acceleration>();
    stop.template operator()<DriveVelocity>();
    stop.template operator()<AngularMomentum>();
    stop.template operator()<AngularVelocity>();
    stop.template operator()<StepAngularVelocity>();
}

/// Separates coincident spheres of two bodies, which have no contact normal, by moving the body
/// with the higher id. The pairs must be known.
void part_coincident(World& world) {
    Table& bodies = world.table<Bodies>();
    const auto ids = rows_by_id(bodies.column<BodyId>());
    const auto names = world.column<SpherePairs, PairKey>();
    const auto rows = world.column<SpherePairs, PairRows>();
    const auto sphere_row = world.column<Spheres, EnlargedSphere>();
    const auto ball = world.column<Spheres, LocalBall>();
    std::vector<double> aside(bodies.size(), 0.0); // by id
    for (std::size_t k = 0; k < names.size(); ++k) {
        const SphereRow &a = sphere_row[rows[k].sphere], &b = sphere_row[rows[k].other];
        const double radius = std::min(ball[rows[k].sphere].radius, ball[rows[k].other].radius);
        if (!((detail::centre_of(a) - detail::centre_of(b)).norm() < 1e-6 * radius)) continue;
        double& separation = aside[std::max(names[k].owner, names[k].partner)];
        separation = std::max(separation, nudge * radius);
    }
    for (EntityId id = 0; id < ids.size(); ++id)
        if (aside[id] > 0 && is_free(bodies, ids[id]))
            bodies.column<Position>()[ids[id]] +=
                aside[id] * Random(parting_stream, id).direction();
}

struct Deepest {
    double overlap = 0; ///< relative to the mean diameter
    PairNames names{nobody, nobody, 0, 0};
};

template <class Pairs>
void find_deepest(const World& world, Deepest& deepest) {
    if (!world.has<Pairs>()) return;
    const auto& index = world.resource<NearIndex<Pairs>>();
    const auto entry = world.column<typename Pairs::Near, NearPair>();
    const auto force = world.column<typename Pairs::Near, PairForce>();
    const auto sphere_row = world.column<Listed, ListedPosition>();
    index.for_touching([&](Row k) {
        double diameter = 2 * sphere_row[entry[k].owner].radius;
        if constexpr (std::is_same_v<Pairs, SpherePairs>)
            diameter = diameter / 2 + sphere_row[entry[k].other].radius;
        if (force[k].overlap / diameter > deepest.overlap)
            deepest = {force[k].overlap / diameter, world.column<Pairs, PairKey>()[entry[k].pair]};
    });
}

Deepest deepest_of(const World& world) {
    Deepest deepest;
    for_each_kind_of_pair([&]<class Pairs>() { find_deepest<Pairs>(world, deepest); });
    return deepest;
}

struct Fastest {
    double speed = 0;
    EntityId body = nobody;
};

Fastest fastest_of(const World& world) {
    const Table& bodies = world.table<Bodies>();
    Fastest fastest;
    for (const Row b : in_order_of_ids(bodies.column<BodyId>()))
        if (is_free(bodies, b) && bodies.column<Velocity>()[b].norm() > fastest.speed)
            fastest = {bodies.column<Velocity>()[b].norm(), bodies.column<BodyId>()[b]};
    return fastest;
}

/// The first free body outside the box of the scene, or nobody.
EntityId escaped(const World& world, const Limits& limits) {
    const Table& bodies = world.table<Bodies>();
    for (const Row b : in_order_of_ids(bodies.column<BodyId>())) {
        const Vec3& x = bodies.column<Position>()[b];
        const bool inside =
            (x.array() >= limits.low.array()).all() && (x.array() <= limits.high.array()).all();
        if (is_free(bodies, b) && !inside) return bodies.column<BodyId>()[b];
    }
    return nobody;
}

/// Stops bodies that move against the force on them, and bodies without force.
void quench(World& world) {
    Table& bodies = world.table<Bodies>();
    for (Row b = 0; b < bodies.size(); ++b) {
        if (!is_free(bodies, b)) continue;
        const double power = bodies.column<Force>()[b].dot(bodies.column<Velocity>()[b]) +
                             bodies.column<Torque>()[b].dot(bodies.column<AngularVelocity>()[b]);
        if (power > 0) continue;
        bodies.column<Velocity>()[b].setZero();
        bodies.column<AngularMomentum>()[b].setZero();
        bodies.column<AngularVelocity>()[b].setZero();
        bodies.column<StepAngularVelocity>()[b].setZero();
    }
    show_velocities(world);
}

/// Speed (m/s) that a tenth of the allowed overlap gives the smallest body: overlap times
/// frequency.
double natural_speed(const World& world, double overlap, double stable) {
    const Table& bodies = world.table<Bodies>();
    double radius = std::numeric_limits<double>::infinity();
    for (Row b = 0; b < bodies.size(); ++b)
        if (is_free(bodies, b)) radius = std::min(radius, bodies.column<BoundingRadius>()[b]);
    return 0.1 * overlap * 2 * radius * 2 / stable;
}

void take_places(World& world, const World& from) {
    Table& bodies = world.table<Bodies>();
    const Table& source = from.table<Bodies>();
    const auto to = rows_by_id(bodies.column<BodyId>()), rows = rows_by_id(source.column<BodyId>());
    for (std::size_t id = 0; id < to.size(); ++id) {
        bodies.column<Position>()[to[id]] = source.column<Position>()[rows[id]];
        if (bodies.has<Orientation>())
            bodies.column<Orientation>()[to[id]] = source.column<Orientation>()[rows[id]];
        if (!is_free(bodies, to[id])) continue;
        bodies.column<Velocity>()[to[id]].setZero();
        bodies.column<Acceleration>()[to[id]].setZero();
        bodies.column<AngularMomentum>()[to[id]].setZero();
        bodies.column<AngularVelocity>()[to[id]].setZero();
        bodies.column<StepAngularVelocity>()[to[id]].setZero();
    }
}

/// A copy of the scene in which only normal springs act.
Simulation make_pushing(const World& world, LawName law, const RelaxSettings& settings) {
    const LawName smooth =
        is_hertz(law) ? LawName::hertz_frictionless : LawName::linear_frictionless;
    World copy(world);
    silence(copy, settings.damping);
    add_lists(copy, smooth);
    rebuild_pairs(copy);
    part_coincident(copy);
    invalidate_lists(copy);
    copy.resource<Clock>().dt = 1e-9 * stable_step_of_first_contact(copy); // to find the contacts
    const PatchStiffness patch = copy.resource<Materials>().policy.patch;
    return Simulation(std::move(copy), steps(smooth, false, patch), settings.threads);
}

} // namespace

Relaxed relax(World& world, LawName law, const RelaxSettings& settings) {
    Simulation pushing = make_pushing(world, law, settings);
    World& now = pushing.world();
    const double first = stable_step_of_first_contact(now);
    pushing.advance();
    Relaxed r;
    Deepest deepest = deepest_of(now);
    r.first_overlap = deepest.overlap;
    r.stored_energy = compute_quantities(now).elastic_energy;
    r.speed_limit =
        settings.speed > 0 ? settings.speed : natural_speed(now, settings.overlap, first);
    Fastest fastest;
    for (;;) {
        r.done = deepest.overlap <= settings.overlap && fastest.speed <= r.speed_limit;
        if (r.done || r.steps >= settings.longest) break;
        now.resource<Clock>().change_step(settings.safety * std::min(stable_step(now), first));
        quench(now);
        pushing.advance(block);
        r.steps += block;
        r.peak_energy = std::max(r.peak_energy, compute_quantities(now).kinetic_energy);
        deepest = deepest_of(now);
        fastest = fastest_of(now);
    }
    r.overlap = deepest.overlap;
    r.speed = fastest.speed;
    if (const EntityId lost = escaped(now, world.resource<Limits>()); lost != nobody) {
        r.done = false;
        r.left = fmt::format("relaxation: expected all bodies inside the box of the scene, found "
                             "body {} outside after {} steps",
                             lost, r.steps);
    } else if (!r.done) {
        r.left = fmt::format("relaxation: expected overlaps of at most {:g} of a diameter and "
                             "speeds of at most {:.3g} m/s, found that bodies {} and {} still "
                             "overlap by {:.4g} and the fastest body has {:.3g} m/s after {} steps",
                             settings.overlap, r.speed_limit, deepest.names.owner,
                             deepest.names.partner, r.overlap, r.speed, r.steps);
    }
    take_places(world, now);
    return r;
}

void relax_start(World& world, LawName law, const Common& common) {
    const Relaxed r = relax(world, law, {.threads = common.threads});
    report_news(common, fmt::format("relaxed in {} steps: largest overlap from {:.3g} to {:.3g} "
                                    "of a diameter",
                                    r.steps, r.first_overlap, r.overlap));
    if (!r.done) throw SimulationError(r.left);
}

} // namespace bris

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "engine/random.hpp"
#include "systems/build/scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/output/balance.hpp"
#include "systems/output/porosity.hpp"
#include "systems/procedure/triaxial.hpp"
#include "systems/servo/platen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

namespace bris {

namespace {

constexpr double first_scale = 0.45;      // at which rocks are put at random places without touching
constexpr double growth_per_step = 2e-4;  // relative, while nothing resists
constexpr double squeezing_limit = 2e-3;  // overlap, of a rock's bounding radius, at which it waits for room
constexpr std::uint64_t growth_block = 20; // steps at one size
constexpr std::uint64_t placing_stream = 2001, vibration_stream = 3001, exchange_stream = 4001;
constexpr std::uint64_t compaction_block = 50; // steps between exchanges
constexpr std::uint64_t porosity_steps = 250;  // between measurements
constexpr std::uint64_t exchange_steps = 2000; // with exchanges, then as many without, in which rocks grow full
constexpr double swelling = 0.002;             // of the core porosity, from the compaction pressure to a test's

void set_friction(World& world, double friction) {
    auto& materials = world.resource<Materials>();
    const auto& specimen = world.resource<Specimen>();
    materials.list[specimen.rock_material].friction = friction;
    materials.list[specimen.platen_material].friction = friction;
    materials.mix();
}

std::span<const EntityId> rocks_of_lift(const Specimen& specimen, std::uint64_t lift, unsigned lifts) {
    const std::size_t n = specimen.rocks.size(), first = n * lift / lifts, last = n * (lift + 1) / lifts;
    return std::span(specimen.rocks).subspan(first, last - first);
}

/// Gives the spheres of some rocks the size that their Growth says.
void resize_rocks(World& world, std::span<const EntityId> rocks) {
    const auto& specimen = world.resource<Specimen>();
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto shape = world.column<Bodies, ShapeOf>();
    const auto run = world.column<Bodies, SpheresOf>();
    const auto growth = world.column<Bodies, Growth>();
    const auto ball = world.column<Spheres, LocalBall>();
    for (const EntityId id : rocks) {
        const Row r = rows[id];
        const Clump& clump = specimen.clumps[shape[r]];
        const double size = growth[r] * specimen.scale[id];
        for (Row k = 0; k < run[r].count; ++k)
            ball[run[r].first + k] = {size * clump.balls[k].centre, size * clump.balls[k].radius};
    }
    invalidate_lists(world);
}

template <class Pairs> void note_overlaps(const World& world, std::span<double> largest) {
    if (!world.has<Pairs>()) return;
    const auto& index = world.resource<NearIndex<Pairs>>();
    const auto force = world.column<typename Pairs::Near, PairForce>();
    for (Row b = 0; b < largest.size(); ++b) {
        for (Row i = index.incident_first[b]; i < index.incident_first[b + 1]; ++i)
            largest[b] = std::max(largest[b], force[index.incident[i]].overlap);
        for (Row k = index.owned_first[b]; k < index.owned_first[b + 1]; ++k)
            largest[b] = std::max(largest[b], force[k].overlap);
    }
}

/// Largest overlap of each body in the last step, by row.
std::vector<double> largest_overlaps(const World& world) {
    std::vector<double> largest(world.table<Bodies>().size(), 0.0);
    for_each_kind_of_pair([&]<class Pairs>() { note_overlaps<Pairs>(world, largest); });
    return largest;
}

/// Lets rocks grow, those excepted that overlap by more than `limit` of their bounding radius; true
/// when all have full size.
bool grow_rocks(World& world, std::span<const EntityId> rocks, double factor, double limit) {
    const auto squeezed = largest_overlaps(world);
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto growth = world.column<Bodies, Growth>();
    const auto radius = world.column<Bodies, BoundingRadius>();
    bool all = true;
    for (const EntityId id : rocks) {
        const Row r = rows[id];
        if (squeezed[r] < limit * radius[r]) growth[r] = std::min(1.0, growth[r] * factor);
        all = all && growth[r] == 1;
    }
    if (!all) resize_rocks(world, rocks);
    return all;
}

double membrane_radius(const World& world) { return world.column<Elements, ElementRadius>().front(); }

/// Puts the rocks of a lift at random places between two heights, their bounding spheres at
/// `scale` clear of each other and of the held sensor rocks.
void place_lift(World& world, std::span<const EntityId> lift, double low, double high, double scale) {
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto& specimen = world.resource<Specimen>();
    const double wall = membrane_radius(world);
    const auto position = world.column<Bodies, Position>();
    const auto motion = world.column<Bodies, MotionOf>();
    const auto radius = world.column<Bodies, BoundingRadius>();
    const auto run = world.column<Bodies, SpheresOf>();
    struct Placed {
        Vec3 position;
        double radius;
    };
    std::vector<Placed> placed;
    for (Row b = 0; b < motion.size(); ++b) // what is already there: held sensor rocks, earlier lifts
        if (run[b].count > 0 && position[b].z() > 0) placed.push_back({position[b], radius[b]});
    std::vector<EntityId> order(lift.begin(), lift.end());
    std::sort(order.begin(), order.end(), [&](EntityId a, EntityId b) {
        return radius[rows[a]] != radius[rows[b]] ? radius[rows[a]] > radius[rows[b]] : a < b;
    });
    for (const EntityId id : order) {
        const Row r = rows[id];
        Random random(specimen.seed, placing_stream + id);
        double size = scale * radius[r];
        for (int attempt = 1;; ++attempt) {
            if (attempt % 500 == 0) size *= 0.97; // a tight place: bounding spheres may overlap
            const double away = (wall - size) * std::sqrt(random.uniform()), angle = 2 * pi * random.uniform();
            const Vec3 x(away * std::cos(angle), away * std::sin(angle), random.uniform(low + size, high - size));
            if (std::any_of(placed.begin(), placed.end(), [&](const Placed& p) {
                    return (p.position - x).squaredNorm() < (size + p.radius) * (size + p.radius);
                }))
                continue;
            position[r] = x;
            placed.push_back({x, size});
            break;
        }
        motion[r] = static_cast<std::uint32_t>(Motion::free);
    }
}

CylinderRegion core(const World& world, double top) {
    const double wall = membrane_radius(world);
    return {0.6 * wall, 0.25 * top, 0.75 * top};
}

template <class... Columns> void swap_rows(World& world, Row a, Row b) {
    (std::swap(world.column<Bodies, Columns>()[a], world.column<Bodies, Columns>()[b]), ...);
}

/// A squeezed rock and one of the same shape, a little smaller, that is squeezed less change places,
/// with all their motion; the larger one starts with the smaller one's size and has to grow. `tries`
/// pairs are drawn. The set of rocks, and so the grading, stays what it is.
void exchange_rocks(World& world, std::uint64_t draw, std::size_t tries) {
    constexpr double least_ratio = 0.9; // of sizes
    const auto& specimen = world.resource<Specimen>();
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto squeezed = largest_overlaps(world);
    const auto shape = world.column<Bodies, ShapeOf>();
    const auto growth = world.column<Bodies, Growth>();
    std::vector<EntityId> order = specimen.rocks; // by shape, then size: partners are neighbours
    std::sort(order.begin(), order.end(), [&](EntityId a, EntityId b) {
        return std::tuple(shape[rows[a]], specimen.scale[a], a) < std::tuple(shape[rows[b]], specimen.scale[b], b);
    });
    Random random(specimen.seed + draw, exchange_stream);
    for (std::size_t k = 0; k < tries; ++k) {
        const std::size_t i = random.bits() % (order.size() - 1);
        const Row small = rows[order[i]], large = rows[order[i + 1]];
        const double ratio = specimen.scale[order[i]] / specimen.scale[order[i + 1]];
        if (shape[small] != shape[large] || ratio < least_ratio || squeezed[large] <= squeezed[small]) continue;
        if (growth[small] < 1 || growth[large] < 1) continue;
        swap_rows<Position, Orientation, Velocity, Acceleration, AngularMomentum, Spin, StepSpin, InertialMass,
                  InertialInertia>(world, small, large);
        growth[large] = ratio;
    }
    invalidate_lists(world);
}

/// The speed (m/s) at which vibrated rocks move: `vibration` of their mean bounding radius in a step.
double vibration_speed(const World& world, double vibration) {
    const auto& rocks = world.resource<Specimen>().rocks;
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    double radius = 0;
    for (const EntityId id : rocks) radius += world.column<Bodies, BoundingRadius>()[rows[id]];
    return vibration * radius / static_cast<double>(rocks.size()) / world.resource<Clock>().dt;
}

/// Gives the rocks, together, the kinetic energy of a speed in each of their six freedoms. Their
/// velocities keep their directions and ratios: drawn anew they would act as a drag on the whole.
void vibrate(World& world, double speed) {
    const auto& rocks = world.resource<Specimen>().rocks;
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto velocity = world.column<Bodies, Velocity>();
    const auto momentum = world.column<Bodies, AngularMomentum>();
    const auto spin = world.column<Bodies, Spin>();
    const auto mass = world.column<Bodies, InertialMass>();
    double found = 0, wanted = 0; // twice the energies
    for (const EntityId id : rocks) {
        const Row r = rows[id];
        found += mass[r] * velocity[r].squaredNorm() + momentum[r].dot(spin[r]);
        wanted += 6 * mass[r] * speed * speed;
    }
    const double scale = std::sqrt(wanted / found);
    for (const EntityId id : rocks) {
        velocity[rows[id]] *= scale;
        momentum[rows[id]] *= scale;
    }
}

double platen_height(const World& world) {
    return world.column<Bodies, Position>()[row_of_body(world, world.resource<Specimen>().top)].z();
}

/// Where a sensor rock belongs in a specimen of the present height.
Vec3 given_position(const World& world, std::size_t sensor) {
    const auto& specimen = world.resource<Specimen>();
    return specimen.smart_rock_poses[sensor].position.cwiseProduct(Vec3(1, 1, platen_height(world) / specimen.height));
}

/// Held sensor rocks sink with the platen: over some steps, to where its height now puts them.
void lead_sensor_rocks(World& world, std::uint64_t steps) {
    const auto& specimen = world.resource<Specimen>();
    const double time = static_cast<double>(steps) * world.resource<Clock>().dt;
    for (std::size_t i = 0; i < specimen.smart_rocks.size(); ++i) {
        const Row r = row_of_body(world, specimen.smart_rocks[i]);
        world.column<Bodies, DriveVelocity>()[r] = (given_position(world, i) - world.column<Bodies, Position>()[r]) / time;
    }
}

/// Everything that is free stands still.
void stop_rocks(World& world) {
    const auto stop = [&]<class Column>() {
        for (auto& value : world.column<Bodies, Column>()) value.setZero();
    };
    stop.template operator()<Velocity>();
    stop.template operator()<AngularMomentum>();
    stop.template operator()<Spin>();
    stop.template operator()<StepSpin>();
}

} // namespace

std::vector<SensorDrift> sensor_drift(const World& world) {
    const auto& specimen = world.resource<Specimen>();
    std::vector<SensorDrift> all;
    for (std::size_t i = 0; i < specimen.smart_rocks.size(); ++i) {
        const Row r = row_of_body(world, specimen.smart_rocks[i]);
        all.push_back({specimen.smart_rocks[i], given_position(world, i), world.column<Bodies, Position>()[r],
                       world.column<Bodies, Orientation>()[r].angularDistance(specimen.smart_rock_poses[i].orientation)});
    }
    return all;
}

// A lift is grown in place between the lifts below and the top platen, without friction (inventory
// T8: pouring alone does not reach the porosity).
void TriaxialTest::start_lift() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    const auto& specimen = world.resource<Specimen>();
    const double height = specimen.looseness * specimen.height;
    if (state.lift == 0) {
        set_friction(world, settings_.compaction_friction);
        world.resource<Gravity>().value.setZero();
        world.resource<LocalDamping>().fraction = settings_.damping;
        forget_lists(world); // rows of spheres are known from here on
    }
    const double lid = height * static_cast<double>(state.lift + 1) / settings_.lifts;
    const auto lift = rocks_of_lift(specimen, state.lift, settings_.lifts);
    place_lift(world, lift, height * static_cast<double>(state.lift) / settings_.lifts, lid, first_scale);
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    for (const EntityId id : lift) world.column<Bodies, Growth>()[rows[id]] = first_scale;
    resize_rocks(world, lift);
    world.column<Bodies, Position>()[row_of_body(world, specimen.top)] = Vec3(0, 0, lid);
    world.resource<Platen>().speed = 0;
    state.phase_steps = 0;
    rescale();
}

// Every block ends with the masses of the next: it begins from State alone, or a resumed run, which
// has no contacts before its first step, would take other masses.
void TriaxialTest::fill() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    if (state.lift == 0 && state.phase_steps == 0) start_lift();
    run(growth_block);
    const bool grown = grow_rocks(world, rocks_of_lift(world.resource<Specimen>(), state.lift, settings_.lifts),
                                  1 + growth_per_step * growth_block, squeezing_limit);
    if (!grown && state.phase_steps > 10 * settings_.longest_stage)
        throw SimulationError(fmt::format("filling: lift {} of {} has no room for its rocks after {} steps; "
                                          "try more rocks or a higher initial porosity",
                                          state.lift + 1, settings_.lifts, state.phase_steps));
    if (grown) {
        run(200);
        state.phase_steps = 0;
        if (++state.lift < settings_.lifts) return start_lift();
        start_compaction();
    }
    rescale();
}

void TriaxialTest::start_compaction() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    auto& platen = world.resource<Platen>();
    const auto& specimen = world.resource<Specimen>();
    const auto& materials = world.resource<Materials>();
    platen.controlled = true;
    platen.target_pressure = settings_.compaction_pressure;
    platen.contact_stiffness = materials.pairs[materials.pair(specimen.rock_material, specimen.platen_material)].kn;
    platen.largest_step = 2e-5 * specimen.height;
    world.resource<LocalDamping>().fraction = 0; // the vibration's energy is set block by block
    Random random(specimen.seed, vibration_stream);
    const double speed = vibration_speed(world, settings_.vibration);
    for (const EntityId id : specimen.rocks)
        world.column<Bodies, Velocity>()[row_of_body(world, id)] = speed * random.normal() * random.direction();
    state.prepared_porosity = 1;
    state.phase = TriaxialPhase::compact;
    state.phase_steps = 0;
}

// The vibrating table: rocks in a rigid mould, under the surcharge of the top platen, are kept in
// agitation without friction until the core is dense enough. Agitation alone jams above the porosity
// of a table that runs for minutes, in which stones find gaps of their size; exchanges stand for
// that, with spells in which the exchanged rocks grow to their size.
void TriaxialTest::compact() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    const auto& rocks = world.resource<Specimen>().rocks;
    vibrate(world, vibration_speed(world, settings_.vibration));
    lead_sensor_rocks(world, compaction_block);
    run(compaction_block);
    rescale();
    const bool measured = state.phase_steps % porosity_steps == 0;
    if (measured) state.prepared_porosity = porosity(world, core(world, platen_height(world)), 120);
    // an exchange leaves rocks that must grow yet: only when all are full does a porosity count
    const bool wanted = std::abs(state.prepared_porosity + swelling - settings_.porosity) <= 0.5 * settings_.porosity_tolerance;
    const bool exchanging = state.phase_steps / exchange_steps % 2 == 0;
    if (!wanted && exchanging) exchange_rocks(world, state.phase_steps, rocks.size() / 20);
    const bool full = grow_rocks(world, rocks, 1 + growth_per_step * compaction_block, 1);
    if (measured && wanted && full) return start_consolidation();
    if (state.phase_steps < settings_.longest_compaction) return;
    throw SimulationError(fmt::format(
        "compaction: expected a core porosity of {:.3f} +/- {:.3f}, came to {:.4f} at a platen pressure of {:.0f} kPa "
        "after {} steps; try a lower compaction friction or a higher porosity",
        settings_.porosity, settings_.porosity_tolerance, state.prepared_porosity,
        world.resource<Platen>().pressure / 1e3, state.phase_steps));
}

void TriaxialTest::start_consolidation() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    auto& membrane = world.resource<Membrane>();
    auto& platen = world.resource<Platen>();
    const double top = platen_height(world);
    membrane.ring_height = top / membrane.rings;
    const auto& materials = world.resource<Materials>();
    const auto& specimen = world.resource<Specimen>();
    set_friction(world, settings_.friction);
    world.resource<LocalDamping>().fraction = settings_.damping;
    for (const EntityId id : specimen.smart_rocks)
        world.column<Bodies, MotionOf>()[row_of_body(world, id)] = static_cast<std::uint32_t>(Motion::free);
    stop_rocks(world);
    if (settings_.gravity) world.resource<Gravity>().value = Vec3(0, 0, -9.81);
    const double wall_contact =
        materials.pairs[materials.pair(specimen.rock_material, specimen.membrane_material)].kn;
    membrane.active = platen.controlled = true;
    membrane.contact_stiffness = platen.contact_stiffness = wall_contact;
    membrane.largest_step = platen.largest_step = 2e-6 * top;
    invalidate_lists(world);
    state.phase = TriaxialPhase::consolidate;
    state.phase_steps = 0;
    rescale();
}

void TriaxialTest::consolidate() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    // set here: one specimen may be taken to several pressures from the same snapshot
    world.resource<Membrane>().target_pressure = settings_.confining_pressure;
    world.resource<Platen>().target_pressure = settings_.confining_pressure;
    run(50);
    if (state.phase_steps % 500 == 0) rescale();
    if (state.phase_steps >= 1000 && is_in_equilibrium()) return start_shear();
    if (state.phase_steps > 10 * settings_.longest_stage)
        throw SimulationError(fmt::format("consolidation: no equilibrium after {} steps: unbalanced ratio {:.2e}",
                                          state.phase_steps, measure_balance(world).unbalanced_ratio));
}

void TriaxialTest::start_shear() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    auto& platen = world.resource<Platen>();
    state.height = platen_height(world);
    state.volume = specimen_volume(world);
    state.global_porosity = 1 - solid_volume(world, {2 * membrane_radius(world), 0, state.height}, 240) / state.volume;
    state.core_porosity = porosity(world, core(world, state.height), 240);
    for (const SensorDrift& d : sensor_drift(world)) {
        state.drift = std::max(state.drift, (d.now - d.given).norm());
        state.turn = std::max(state.turn, d.turn);
    }
    platen.controlled = false;
    platen.speed = 0;
    state.phase = TriaxialPhase::shear;
    state.stage = 0;
    state.phase_steps = 0;
    state.points.push_back(measure_point());
    rescale();
}

} // namespace bris

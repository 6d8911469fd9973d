#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/platen.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "engine/random.hpp"
#include "scenarios/specimens/growth.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/triaxial/specimen_state.hpp"
#include "scenarios/triaxial/triaxial.hpp"
#include "systems/broadphase/lists.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

namespace bris {

namespace {

// overlap over bounding radius at which an exchanged rock stops growing until it has room
constexpr double exchange_limit = 1e-2;
constexpr std::uint64_t vibration_block = 50; // steps between resets of the energy and exchanges
constexpr std::uint64_t porosity_steps = 250; // between measurements of porosity
// steps with exchanges, followed by as many without, in which rocks grow to full size
constexpr std::uint64_t exchange_steps = 2000;
// increase of the core porosity by vibration, as far as it can be known before the first taps
constexpr double swelling = 0.015;
constexpr double vibration = 2.5e-4; // displacement of a rock in a step, over its bounding radius
constexpr std::uint64_t vibration_stream = 3001, exchange_stream = 4001;

template <class... Columns>
void swap_rows(World& world, Row a, Row b) {
    (std::swap(world.column<Bodies, Columns>()[a], world.column<Bodies, Columns>()[b]), ...);
}

/// Exchanges a rock and a slightly smaller one of the same shape that has smaller overlaps: they
/// swap positions and motions, and the larger one starts at the size of the smaller one and has to
/// grow. A rock without room to grow is exchanged in the same way. `tries` pairs are drawn; with
/// `only_stuck` only rocks below full size are exchanged. The set of rocks, and so the grading, is
/// unchanged.
void exchange_rocks(World& world, std::span<const double> squeezed, std::uint64_t draw,
                    std::size_t tries, bool only_stuck) {
    constexpr double least_ratio = 0.9; // of the sizes of the two rocks
    const auto& specimen = world.resource<Specimen>();
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto shape = world.column<Bodies, ShapeOf>();
    const auto growth = world.column<Bodies, Growth>();
    std::vector<EntityId> order = specimen.rocks; // by shape, then size: partners are neighbours
    std::sort(order.begin(), order.end(), [&](EntityId a, EntityId b) {
        return std::tuple(shape[rows[a]], specimen.scale[a], a) <
               std::tuple(shape[rows[b]], specimen.scale[b], b);
    });
    Random random(specimen.seed + draw, exchange_stream);
    for (std::size_t k = 0; k < tries; ++k) {
        const std::size_t i = random.bits() % (order.size() - 1);
        const Row small = rows[order[i]], large = rows[order[i + 1]];
        const double ratio = specimen.scale[order[i]] / specimen.scale[order[i + 1]];
        if (shape[small] != shape[large] || ratio < least_ratio ||
            squeezed[large] <= squeezed[small])
            continue;
        if (growth[small] < 1 || growth[large] < ratio || (only_stuck && growth[large] == 1))
            continue;
        swap_rows<Position, Orientation, Velocity, Acceleration, AngularMomentum, AngularVelocity,
                  StepAngularVelocity, InertialMass, InertialInertia>(world, small, large);
        growth[large] = ratio;
        invalidate_lists(world);
    }
}

/// Speed (m/s) of vibrated rocks.
double vibration_speed(const World& world) {
    const auto& rocks = world.resource<Specimen>().rocks;
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    double radius = 0;
    for (const EntityId id : rocks) radius += world.column<Bodies, BoundingRadius>()[rows[id]];
    return vibration * radius / static_cast<double>(rocks.size()) / world.resource<Clock>().dt;
}

/// Scales the motion of the rocks to the kinetic energy that corresponds to `speed` in each of
/// their six degrees of freedom. Velocities keep their directions and ratios: velocities drawn anew
/// would act as a drag on the specimen as a whole.
void agitate(World& world, double speed) {
    const auto& rocks = world.resource<Specimen>().rocks;
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto velocity = world.column<Bodies, Velocity>();
    const auto momentum = world.column<Bodies, AngularMomentum>();
    const auto angular_velocity = world.column<Bodies, AngularVelocity>();
    const auto mass = world.column<Bodies, InertialMass>();
    double found = 0, wanted = 0; // twice the energies
    for (const EntityId id : rocks) {
        const Row r = rows[id];
        found += mass[r] * velocity[r].squaredNorm() + momentum[r].dot(angular_velocity[r]);
        wanted += 6 * mass[r] * speed * speed;
    }
    const double scale = std::sqrt(wanted / found);
    for (const EntityId id : rocks) {
        velocity[rows[id]] *= scale;
        momentum[rows[id]] *= scale;
    }
    show_velocities(world);
}

} // namespace

void TriaxialTest::start_vibration() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    const auto& specimen = world.resource<Specimen>();
    world.resource<LocalDamping>().fraction = 0; // agitate sets the energy block by block
    world.resource<Limits>().impact_allowance = allowance_when_shaken;
    Random random(specimen.seed + state.rounds, vibration_stream);
    const double speed = vibration_speed(world);
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    for (const EntityId id : specimen.rocks) {
        const Vec3 direction = random.direction();
        world.column<Bodies, Velocity>()[rows[id]] = speed * random.normal() * direction;
    }
    show_velocities(world);
    if (state.rounds == 0) state.porosity_before_taps += swelling;
    state.phase = TriaxialPhase::vibrate;
    state.phase_steps = 0;
}

// Models a vibrating table: rocks in a rigid mould, under the surcharge of the top platen, are
// vibrated without friction until the core is dense enough. Vibration alone jams above the porosity
// that a table reaches in minutes, during which rocks find gaps of their size. Exchanges of rocks
// stand in for that, alternating with periods in which the exchanged rocks grow to full size.
void TriaxialTest::vibrate() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    const auto& rocks = world.resource<Specimen>().rocks;
    agitate(world, vibration_speed(world));
    run(vibration_block);
    rescale();
    lead_sensor_rocks(world, vibration_block); // in the next block: only now are forces known
    const bool measured = state.phase_steps % porosity_steps == 0;
    if (measured) measure_porosity();
    const bool dense = state.prepared_porosity <= state.porosity_before_taps;
    const bool exchanging = state.phase_steps / exchange_steps % 2 == 0;
    const auto squeezed = largest_overlaps(world);
    if (exchanging) exchange_rocks(world, squeezed, state.phase_steps, rocks.size() / 20, dense);
    // after an exchange some rocks are below full size, so a porosity counts only when none is
    const bool full =
        grow_rocks(world, rocks, squeezed, 1 + growth_per_step * vibration_block, exchange_limit);
    if (full) state.densest_porosity = std::min(state.densest_porosity, state.prepared_porosity);
    if (measured && dense && full) return start_taps();
    if (state.phase_steps < settings_.longest_preparation) return;
    // at the start of shearing, if taps and consolidation change it as they are expected to
    const double reached =
        state.densest_porosity + settings_.core_porosity() - state.porosity_before_taps;
    throw SimulationError(fmt::format(
        "preparation: expected a core porosity of {:.3f} +- {:.3f}, found that {} steps of "
        "vibration reach {:.3f} (before taps and consolidation: {:.3f}); choose --porosity of at "
        "least {:.3f} or a larger --longest-preparation",
        settings_.core_porosity(), settings_.porosity_tolerance, state.phase_steps, reached,
        state.densest_porosity, reached));
}

} // namespace bris

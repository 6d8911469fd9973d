#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/platen.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "engine/random.hpp"
#include "scenarios/triaxial/specimen_state.hpp"
#include "scenarios/triaxial/triaxial.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/output/balance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr std::uint64_t tap_block = 50; // steps between checks of rest
constexpr double at_rest = 5e-3;        // unbalanced force ratio
constexpr double energy_of_tap = 1.5;   // over pressure times volume of the rocks
// Largest overlap of two rocks if all energy of one is stored in a contact, over the bounding
// radius of the smallest rock: in a wide grading the largest rocks would squeeze the smallest ones.
constexpr double overlap_of_tap = 0.3;
constexpr std::uint64_t more_taps = 8; // at most, to meet the porosity
constexpr double met_within = 0.3;     // of the tolerance of the porosity
constexpr std::uint64_t most_rounds = 6;
constexpr std::uint64_t tap_stream = std::uint64_t{1} << 33;

/// Gives all rocks random velocities and angular velocities. `energy`: mean kinetic energy of a
/// rock over its volume (Pa), about; the same for all sizes, so that no small rock is shot into
/// others, but limited by overlap_of_tap.
void kick(World& world, double energy, std::uint64_t draw) {
    const auto& specimen = world.resource<Specimen>();
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto velocity = world.column<Bodies, Velocity>();
    const auto momentum = world.column<Bodies, AngularMomentum>();
    const auto mass = world.column<Bodies, Mass>();
    const auto inertial_mass = world.column<Bodies, InertialMass>();
    const auto inertia = world.column<Bodies, InertialInertia>();
    const auto& materials = world.resource<Materials>();
    const double density = materials.list[specimen.rock_material].density;
    const auto radius = world.column<Bodies, BoundingRadius>();
    double smallest = radius[rows[specimen.rocks.front()]];
    for (const EntityId id : specimen.rocks) smallest = std::min(smallest, radius[rows[id]]);
    const double overlap = overlap_of_tap * smallest;
    const double stiffness =
        materials.linear_pairs[materials.pair(specimen.rock_material, specimen.rock_material)].kn;
    for (const EntityId id : specimen.rocks) {
        const Row r = rows[id];
        Random random(specimen.seed + draw, tap_stream + id);
        const double of_freedom =
            std::min(energy * mass[r] / density, 0.5 * stiffness * overlap * overlap) / 6;
        for (int a = 0; a < 3; ++a) {
            velocity[r][a] = std::sqrt(2 * of_freedom / inertial_mass[r]) * random.normal();
            momentum[r][a] = std::sqrt(2 * of_freedom * inertia[r].x()) * random.normal();
        }
    }
    show_velocities(world);
}

} // namespace

void TriaxialTest::start_taps() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    world.resource<LocalDamping>().fraction = settings_.damping;
    world.resource<Limits>().impact_allowance = allowance_when_shaken;
    set_friction(world, preparation_friction());
    state.phase = TriaxialPhase::tap;
    state.phase_steps = 0;
    state.taps = 0;
}

// The contacts that formed with little friction are more numerous than those of poured or tapped
// rocks, and make a specimen several times stiffer (Agnolin and Roux, Phys. Rev. E 76 (2007)
// 061302). Taps with the friction of the rocks replace them, and hardly change the porosity.
void TriaxialTest::tap() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    run(tap_block);
    rescale();
    // in the next block: only now are forces known
    lead_sensor_rocks(world, tap_block, is_late());
    if (state.phase_steps > settings_.longest_preparation)
        throw SimulationError(fmt::format(
            "taps: expected rest at {:.4g} kPa on the top platen, found {:.4g} kPa and an "
            "unbalanced force ratio of {:.1e} after {} steps and {} taps",
            world.resource<Platen>().target_pressure / 1e3, world.resource<Platen>().pressure / 1e3,
            compute_balance(world).unbalanced_ratio, state.phase_steps, state.taps));
    if (!rests_under_platen(at_rest)) return;
    measure_porosity();
    const double off = state.prepared_porosity - state.aim;
    const std::uint64_t least = settings_.taps, most = least > 0 ? least + more_taps : 0;
    if (state.taps >= least && std::abs(off) <= met_within * settings_.porosity_tolerance)
        return start_consolidation();
    if (state.taps < most && (state.taps < least || off > 0))
        return kick(world, energy_of_tap * world.resource<Platen>().target_pressure,
                    state.taps++ + most * state.rounds);
    if (std::abs(off) <= settings_.porosity_tolerance) return start_consolidation();
    prepare_again(off);
}

// `off`: by which the core porosity after the taps is too high
void TriaxialTest::prepare_again(double off) {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    state.porosity_before_taps -= off;
    if (state.porosity_before_taps < state.poured_porosity &&
        state.rounds++ < most_rounds * (state.trials + 1)) {
        if (off > 0) return continue_compression();
        state.phase = TriaxialPhase::fill; // only poured anew do the rocks become looser
        state.phase_steps = 0;
        return;
    }
    // at the start of shearing, if consolidation changes it as it did in the trials
    const double reached = state.prepared_porosity + settings_.core_porosity() - state.aim;
    throw SimulationError(fmt::format(
        "preparation: expected a core porosity of {:.3f} +- {:.3f}, found {:.4f} after {} taps and "
        "{} trial consolidations (as poured: {:.3f}); choose --porosity {:.3f} or a larger "
        "--porosity-tolerance",
        settings_.core_porosity(), settings_.porosity_tolerance, reached, state.taps, state.trials,
        state.poured_porosity, reached));
}

} // namespace bris

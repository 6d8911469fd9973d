#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/platen.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "scenarios/triaxial/specimen_state.hpp"
#include "scenarios/triaxial/triaxial.hpp"
#include "systems/output/balance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr std::uint64_t compression_block = 50; // steps between changes of friction
constexpr std::uint64_t porosity_steps = 250;   // between measurements of porosity
// A pair of rocks under the pressure p overlaps by about p d / k_n of its size d. The pressure
// follows the stiffness, so that this is 1/3000 for the mean size, whatever the stiffness.
constexpr double stiffness_over_pressure = 3000;
// Friction is reduced only while the unbalanced force ratio is below this and the pressure of the
// platen is met, so that the rocks settle from one equilibrium to the next.
constexpr double quasi_static = 0.02, pressure_error = 0.05;
constexpr double friction_left = 0.99; // after a block
constexpr double least_friction = 5e-3;
// Taps change the porosity after compression: loose rocks settle, dense ones dilate. First guess,
// measured with 400 rocks; later taps of the same specimen correct it.
constexpr double settled_by_taps = 0.2, unchanged_by_taps = 0.40;

} // namespace

double TriaxialTest::preparation_friction() const {
    return settings_.preparation_friction < 0 ? settings_.friction : settings_.preparation_friction;
}

void TriaxialTest::press_platen() {
    World& world = simulation_.world();
    auto& platen = world.resource<Platen>();
    const auto& specimen = world.resource<Specimen>();
    const auto& materials = world.resource<Materials>();
    const auto stiffness = [&](std::uint32_t partner) {
        return materials.linear_pairs[materials.pair(specimen.rock_material, partner)].kn;
    };
    platen.controlled = true;
    platen.target_pressure =
        settings_.preparation_pressure > 0
            ? settings_.preparation_pressure
            : std::min(stiffness(specimen.rock_material), stiffness(specimen.platen_material)) /
                  (stiffness_over_pressure * mean_size(world));
    platen.contact_stiffness = stiffness(specimen.platen_material);
    platen.largest_step = 2e-5 * specimen.height;
}

// The platen presses the rocks down in the rigid mould. With their friction they come to rest as
// loose as when they are poured; then friction is reduced and they settle until they are as dense
// as wanted.
void TriaxialTest::start_compression() {
    auto& state = simulation_.world().resource<TriaxialState>();
    press_platen();
    state.preparation_friction = preparation_friction();
    if (state.rounds == 0) {
        state.aim = settings_.core_porosity();
        state.porosity_before_taps = state.aim + settled_by_taps * (state.aim - unchanged_by_taps);
    }
    set_friction(simulation_.world(), state.preparation_friction);
    continue_compression();
    rescale();
}

void TriaxialTest::continue_compression() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    world.resource<LocalDamping>().fraction = settings_.damping;
    set_friction(world, state.preparation_friction);
    state.prepared_porosity = 1;
    state.phase = TriaxialPhase::compress;
    state.phase_steps = 0;
}

void TriaxialTest::measure_porosity() {
    World& world = simulation_.world();
    world.resource<TriaxialState>().prepared_porosity = porosity(world, core(world), 120);
}

bool TriaxialTest::rests_under_platen(double unbalanced_ratio) const {
    const World& world = std::as_const(simulation_).world();
    const auto& platen = world.resource<Platen>();
    return std::abs(platen.pressure / platen.target_pressure - 1) < pressure_error &&
           compute_balance(world).unbalanced_ratio < unbalanced_ratio;
}

// After a quarter of the longest preparation, sensor rocks that move to and fro are the likely
// cause.
bool TriaxialTest::is_late() const {
    return state().phase_steps > settings_.longest_preparation / 4;
}

void TriaxialTest::compress() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    run(compression_block);
    rescale();
    // in the next block: only now are forces known
    lead_sensor_rocks(world, compression_block, is_late());
    if (state.phase_steps % porosity_steps == 0) measure_porosity();
    if (state.phase_steps > settings_.longest_preparation)
        throw SimulationError(fmt::format(
            "compression: expected rest at {:.4g} kPa on the top platen, found {:.4g} kPa and an "
            "unbalanced force ratio of {:.1e} after {} steps",
            world.resource<Platen>().target_pressure / 1e3, world.resource<Platen>().pressure / 1e3,
            compute_balance(world).unbalanced_ratio, state.phase_steps));
    if (state.poured_porosity > 0 && state.prepared_porosity <= state.porosity_before_taps)
        return start_taps();
    if (!rests_under_platen(quasi_static)) return;
    if (state.poured_porosity == 0) {
        measure_porosity();
        state.poured_porosity = state.prepared_porosity;
        if (state.poured_porosity < settings_.core_porosity() - settings_.porosity_tolerance)
            throw SimulationError(fmt::format(
                "preparation: expected a core porosity of {:.3f} +- {:.3f}, found that these rocks "
                "are denser as poured, {:.3f}; choose --porosity below {:.3f} or a higher "
                "--friction",
                settings_.core_porosity(), settings_.porosity_tolerance, state.poured_porosity,
                state.poured_porosity));
    }
    if (state.preparation_friction == 0)
        return state.prepared_porosity <= state.aim + settings_.porosity_tolerance
                   ? start_taps()
                   : start_vibration();
    state.preparation_friction *= friction_left;
    if (state.preparation_friction < least_friction) state.preparation_friction = 0;
    set_friction(world, state.preparation_friction);
}

std::string TriaxialTest::preparation_status() const {
    const TriaxialState& s = state();
    const std::string found =
        s.prepared_porosity < 1 ? fmt::format("{:.3f}", s.prepared_porosity) : "unknown";
    const std::string status =
        fmt::format("core porosity {} (target {:.3f}), ", found, settings_.core_porosity());
    if (s.phase == TriaxialPhase::compress)
        return status +
               fmt::format("friction {:.2f}, step {}", s.preparation_friction, s.phase_steps);
    if (s.phase == TriaxialPhase::tap) return status + fmt::format("tap {}", s.taps);
    return status +
           fmt::format("step {} of at most {}", s.phase_steps, settings_.longest_preparation);
}

} // namespace bris

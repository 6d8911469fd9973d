#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/membrane.hpp"
#include "components/platen.hpp"
#include "components/settings.hpp"
#include "engine/clock.hpp"
#include "engine/errors.hpp"
#include "scenarios/triaxial/specimen_state.hpp"
#include "scenarios/triaxial/triaxial.hpp"
#include "systems/output/balance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr std::uint64_t points_of_half = 16;
constexpr std::uint64_t longest_block = 2000; // steps, in a rest
constexpr std::uint64_t steps_at_end = 20;    // between checks of equilibrium
// Of the height, for platen and membrane in a step: far beyond the speeds of loading, so that only
// a specimen that fails meets it.
constexpr double largest_step = 1e-5;

/// Dashpots between rocks, and local damping of all. Servo walls are so light that a dashpot of the
/// rocks would throw them about.
void set_damping(World& world, double restitution, double local) {
    auto& materials = world.resource<Materials>();
    const auto& specimen = std::as_const(world).resource<Specimen>();
    world.resource<LocalDamping>().fraction = local;
    if (restitution == 1) return;
    for (const auto rock : {specimen.rock_material, specimen.sensor_material}) {
        materials.list[rock].restitution = restitution;
        for (const auto wall : {specimen.membrane_material, specimen.platen_material})
            materials.set_pair(rock, wall, {.restitution = 1});
    }
}

} // namespace

PhaseProgress TriaxialTest::cycles_progress() const {
    const TriaxialState& s = state();
    const double count = settings_.cycles.count, done = static_cast<double>(s.stage),
                 part = s.cyclic.present[&LoadPoint::cycle].back();
    return {fmt::format("{:.0f} kPa cycles", settings_.confining_pressure / 1e3), part / count,
            fmt::format("cycle {} of {}, axial strain {:.2f} %", s.stage + 1, count,
                        100 * s.cyclic.present[&LoadPoint::axial_strain].back()),
            1 + done};
}

void TriaxialTest::start_cycles() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    auto& platen = world.resource<Platen>();
    const LoadCycles& cycles = settings_.cycles;
    platen.controlled = true;
    platen.largest_step = world.resource<Membrane>().largest_step = largest_step * state.height;
    platen.axial_load.area = cycles.area == "nominal" ? state.volume / state.height : 0;
    platen.axial_load.mass = cycles.platen_mass;
    set_damping(world, cycles.restitution, cycles.damping < 0 ? settings_.damping : cycles.damping);
    if (cycles.platen_mass > 0) platen.damping = world.resource<LocalDamping>().fraction;
    state.phase = TriaxialPhase::cycle;
    state.stage = 0;
    state.cyclic.began = world.resource<Clock>().time();
    add_stage();
    rescale();
    add_load_point();
    start_half_cycle();
}

/// Adds the present state to the points of this cycle.
void TriaxialTest::add_load_point() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    const SpecimenLoad now = specimen_load(world);
    const auto& membrane = std::as_const(world).resource<Membrane>();
    double worst = 0;
    for (const double pressure : membrane.pressure)
        worst = std::max(worst, std::abs(pressure / membrane.target_pressure - 1));
    const double part = static_cast<double>(state.cyclic.points) / points_of_half;
    state.cyclic.present.add({.cycle = 0.5 * (static_cast<double>(state.cyclic.halves) + part),
                              .time = world.resource<Clock>().time() - state.cyclic.began,
                              .q = now.axial_stress - now.radial_stress,
                              .axial_strain = 1 - now.height / state.height,
                              .volumetric_strain = 1 - now.volume / state.volume,
                              .worst_ring_error = worst});
}

void TriaxialTest::start_half_cycle() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    const auto& clock = world.resource<Clock>();
    auto& load = world.resource<Platen>().axial_load;
    const LoadCycles& cycles = settings_.cycles;
    const std::uint64_t halves = state.cyclic.halves;
    const bool follows = halves > 0 && !cycles.are_quasi_static();
    load.start = follows ? load.start + load.duration + cycles.rest_after(halves) : clock.time();
    load.duration =
        cycles.are_quasi_static() ? cycles.half_steps * clock.dt : 0.5 / cycles.frequency;
    load.from = cycles.level_after(halves);
    load.to = cycles.level_after(halves + 1);
    state.cyclic.points = 0;
    state.phase_steps = 0;
}

// Runs to the next point of the half cycle, or a part of the way if it is far, in a rest.
// Quasi-static half cycles end at rest.
void TriaxialTest::cycle() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    const auto& clock = world.resource<Clock>();
    const LoadRamp& load = world.resource<Platen>().axial_load;
    const double next = load.start + load.duration * static_cast<double>(state.cyclic.points + 1) /
                                         static_cast<double>(points_of_half);
    const double left = std::ceil((next - clock.time()) / clock.dt - 1e-6);
    const bool arrived = left <= static_cast<double>(longest_block);
    const bool waits = left < 1 && settings_.cycles.are_quasi_static();
    run(waits     ? steps_at_end
        : arrived ? static_cast<std::uint64_t>(std::max(1.0, left))
                  : longest_block);
    keep_stable();
    const bool ends = arrived && state.cyclic.points + 1 == points_of_half;
    if (ends && settings_.cycles.are_quasi_static() && !is_in_equilibrium()) {
        if (state.phase_steps > settings_.longest_stage + settings_.cycles.half_steps)
            throw SimulationError(
                fmt::format("cycle {}: no equilibrium at q = {:.4g} kPa after {} steps: {}",
                            state.cyclic.halves / 2 + 1, load.to / 1e3, state.phase_steps,
                            equilibrium_status()));
        return;
    }
    if (!arrived) return;
    ++state.cyclic.points;
    add_load_point();
    if (std::abs(state.cyclic.present[&LoadPoint::axial_strain].back()) >=
        settings_.cycles.largest_strain) {
        end_cycle(); // it has failed
        state.phase = TriaxialPhase::done;
    } else if (ends) {
        end_half_cycle();
    }
}

void TriaxialTest::end_half_cycle() {
    auto& state = simulation_.world().resource<TriaxialState>();
    ++state.cyclic.halves;
    state.cyclic.points = 0;
    rescale();
    if (state.cyclic.halves % 2 == 0) {
        end_cycle();
        if (state.stage == settings_.cycles.count) state.phase = TriaxialPhase::done;
    }
    if (state.phase != TriaxialPhase::done) start_half_cycle();
}

/// Keeps what this cycle has shown, whether it is complete or the specimen has failed in it.
void TriaxialTest::end_cycle() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    CyclicState& cyclic = state.cyclic;
    const bool complete = cyclic.halves == 2 * (state.stage + 1);
    if (complete) {
        ++state.stage;
        cyclic.responses.add(response_of(cyclic.present, compute_balance(world).unbalanced_ratio));
    }
    const bool last = !complete || state.stage == settings_.cycles.count;
    if (last || is_shown_cycle(state.stage)) {
        add_stage();
        for (std::size_t k = 0; k < cyclic.present.rows(); ++k)
            cyclic.loops.add(cyclic.present.at(k));
    }
    const LoadPoint end = cyclic.present.at(cyclic.present.rows() - 1);
    cyclic.present = SeriesOf<LoadPoint>("present_cycle");
    cyclic.present.add(end);
}

} // namespace bris

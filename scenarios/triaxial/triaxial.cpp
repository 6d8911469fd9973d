#include "scenarios/triaxial/triaxial.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/membrane.hpp"
#include "components/platen.hpp"
#include "components/settings.hpp"
#include "components/sleeve.hpp"
#include "scenarios/specimens/equilibrium.hpp"
#include "scenarios/specimens/true_masses.hpp"
#include "systems/contact/mass_scaling.hpp"
#include "systems/output/balance.hpp"
#include "systems/output/stress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

/// How far compression is: it ends when the porosity is met, or friction, which falls from `first`
/// by the same factor in each block at rest, is nearly nothing.
double compressed_share(const TriaxialState& s, double first) {
    constexpr double last = 5e-3;
    if (s.poured_porosity == 0) return 0; // they are still poured
    const double whole = s.poured_porosity - s.porosity_before_taps,
                 by_porosity = whole > 0 ? (s.poured_porosity - s.prepared_porosity) / whole : 1,
                 now = std::max(last, s.preparation_friction),
                 by_friction = first > last ? std::log(first / now) / std::log(first / last) : 1;
    return std::clamp(std::max(by_porosity, by_friction), 0.0, 1.0);
}

} // namespace

void TriaxialState::save(Archive& archive) const {
    const std::array<std::uint64_t, 7> counts{
        static_cast<std::uint64_t>(phase), stage, phase_steps, taps, rounds, trials,
        accepted ? std::uint64_t{1} : 0};
    archive.put("triaxial/counts", std::span<const std::uint64_t>(counts));
    put_fields(archive, "triaxial/numbers", fields(*this));
    save_curves(archive, "triaxial", curves);
    cyclic.save(archive);
}

void TriaxialState::load(const Archive& archive) {
    const auto counts = archive.get<std::uint64_t>("triaxial/counts");
    phase = static_cast<TriaxialPhase>(counts.at(0));
    stage = counts.at(1);
    phase_steps = counts.at(2);
    taps = counts.at(3);
    rounds = counts.at(4);
    trials = counts.at(5);
    accepted = counts.at(6) != 0;
    get_fields(archive, "triaxial/numbers", fields(*this));
    curves = load_curves(archive, "triaxial");
    cyclic.load(archive);
}

TriaxialTest::TriaxialTest(Simulation& simulation, TriaxialSettings settings)
    : simulation_(simulation), settings_(settings) {
    World& world = simulation_.world();
    if (!world.has_resource<TriaxialState>()) world.add_resource<TriaxialState>();
}

const TriaxialState& TriaxialTest::state() const {
    return static_cast<const World&>(simulation_.world()).resource<TriaxialState>();
}

void TriaxialTest::run(std::uint64_t steps) {
    simulation_.advance(steps);
    simulation_.world().resource<TriaxialState>().phase_steps += steps;
}

/// The frequency of load cycles is that of the true masses.
bool TriaxialTest::masses_are_scaled() const {
    const TriaxialPhase phase = state().phase;
    if (phase < TriaxialPhase::consolidate) return true;
    return settings_.mass_scaling &&
           (phase != TriaxialPhase::cycle || settings_.cycles.are_quasi_static());
}

// for the contacts of the last step
void TriaxialTest::rescale() {
    World& world = simulation_.world();
    const double dt = masses_are_scaled() ? scale_masses(world, 0, settings_.safety, false).dt
                                          : settings_.safety * restore_masses(world);
    world.resource<Clock>().change_step(dt);
}

// contacts that formed since the stage began may make the time step unstable: masses are raised, or
// the step is shortened
void TriaxialTest::keep_stable() {
    World& world = simulation_.world();
    auto& clock = world.resource<Clock>();
    if (masses_are_scaled()) {
        scale_masses(world, clock.dt, settings_.safety, true);
        return;
    }
    const double dt = settings_.safety * restore_masses(world);
    if (dt < clock.dt) clock.change_step(dt);
}

bool TriaxialTest::advance() {
    switch (state().phase) {
    case TriaxialPhase::fill:
        fill();
        break;
    case TriaxialPhase::compress:
        compress();
        break;
    case TriaxialPhase::vibrate:
        vibrate();
        break;
    case TriaxialPhase::tap:
        tap();
        break;
    case TriaxialPhase::consolidate:
        consolidate();
        break;
    case TriaxialPhase::shear:
        shear();
        break;
    case TriaxialPhase::cycle:
        cycle();
        break;
    case TriaxialPhase::done:
        break;
    }
    return state().phase != TriaxialPhase::done;
}

bool TriaxialTest::is_in_equilibrium() {
    const World& world = std::as_const(simulation_).world();
    const Balance balance = compute_balance(world);
    unbalanced_ratio_ = balance.unbalanced_ratio;
    pressure_error_ = stress_mismatch_ = 0;
    const auto consider = [&](double pressure, double wanted) {
        const double error = std::abs(pressure / wanted - 1);
        if (!(error <= pressure_error_)) pressure_error_ = error; // also if it is not a number
    };
    const auto& platen = world.resource<Platen>();
    if (platen.controlled) consider(platen.pressure, platen.wanted);
    for (const double pressure : world.resource<Membrane>().pressure)
        consider(pressure, settings_.confining_pressure);
    if (world.has_resource<Sleeve>()) consider(1 + world.resource<Sleeve>().unbalanced, 1);
    if (!carries_load(balance)) return false;
    if (!(balance.unbalanced_ratio <= settings_.tolerance)) return false;
    if (!(pressure_error_ <= settings_.pressure_tolerance)) return false;
    // small unbalanced forces on many rocks add up to a larger stress mismatch in a large specimen
    stress_mismatch_ = compute_stresses(world).mismatch();
    return stress_mismatch_ <= settings_.pressure_tolerance;
}

/// Found and largest accepted values of what is_in_equilibrium has checked last.
std::string TriaxialTest::equilibrium_status() const {
    std::string text = fmt::format(
        "unbalanced force ratio {:.1e} (target {:.0e}), pressure error {:.1f} % (target {:g} %)",
        unbalanced_ratio_, settings_.tolerance, 100 * pressure_error_,
        100 * settings_.pressure_tolerance);
    if (stress_mismatch_ > settings_.pressure_tolerance)
        text += fmt::format(", stresses of boundaries and contacts apart by {:.1f} % (target {:g} "
                            "%)",
                            100 * stress_mismatch_, 100 * settings_.pressure_tolerance);
    const Balance balance = compute_balance(std::as_const(simulation_).world());
    if (!carries_load(balance))
        text += fmt::format(", {} contacts of {} rocks", balance.contacts, balance.free_bodies);
    return text;
}

// the lengths of vibration, taps and consolidation are not known in advance
PhaseProgress TriaxialTest::progress() const {
    const TriaxialState& s = state();
    const double unknown = -1, stages = settings_.final_axial_strain / settings_.stage_strain;
    const std::string at = fmt::format("{:.0f} kPa ", settings_.confining_pressure / 1e3);
    switch (s.phase) {
    case TriaxialPhase::fill:
        return filling_progress();
    case TriaxialPhase::compress:
        return {"preparation", compressed_share(s, preparation_friction()), preparation_status()};
    case TriaxialPhase::vibrate:
    case TriaxialPhase::tap:
        return {"preparation", unknown, preparation_status()};
    case TriaxialPhase::consolidate:
        return {at + "consolidation", unknown, consolidation_status()};
    case TriaxialPhase::shear:
        return {at + "shear", static_cast<double>(s.stage) / stages,
                fmt::format("axial strain {:.2f} of {:g} %, q {:.0f} kPa",
                            100 * static_cast<double>(s.stage) * settings_.stage_strain,
                            100 * settings_.final_axial_strain,
                            s.curves.empty() ? 0.0
                                             : s.curves[quantity::deviatoric_stress].back() / 1e3),
                static_cast<double>(s.curves.size())};
    case TriaxialPhase::cycle:
        return cycles_progress();
    case TriaxialPhase::done:
        break;
    }
    return {at + "done", 1};
}

} // namespace bris

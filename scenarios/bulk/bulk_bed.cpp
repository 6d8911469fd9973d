#include "scenarios/bulk/bulk_bed.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/settings.hpp"
#include "systems/output/quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace bris {

namespace {

constexpr std::uint64_t block = 100, look_every = 500; // steps
constexpr double damped_restitution = 0.1; // while hardening turns overlaps into velocities
// a bed oscillates on its floor with a period of some thousand steps, whatever its stiffness (the
// time step scales with it): a tenth in 300 steps is slow, while doubling at once threw beds up
constexpr double stage_factor = 1.1;

struct Pair {
    std::uint32_t a, b;
    double restitution, friction;
};
// Table 2 of Dosta et al. (2024), with the values of their input files
constexpr std::array pairs{Pair{0, 0, 0.5, 0.3}, Pair{1, 1, 0.4, 0.4}, Pair{0, 1, 0.45, 0.2},
                           Pair{0, 2, 0.4, 0.2}, Pair{1, 2, 0.4, 0.2}, Pair{2, 2, 0.6, 0.5}};
constexpr std::array young_moduli{1e9, 0.5e9, 210e9};

/// Stiffness while pouring, as a fraction of that of the run.
double softest(const BedSettings& s) { return std::min(1.0, s.softness / s.stiffness); }

} // namespace

BulkMaterials add_bulk_materials(World& world) {
    auto& materials = world.resource<Materials>();
    const auto add = [&](const char* name, double density) {
        Material m;
        m.name = name;
        m.density = density;
        m.poisson_ratio = 0.2;
        m.young_modulus = young_moduli[materials.list.size()];
        return materials.add(m);
    };
    const BulkMaterials numbers{add("M1", 2500), add("M2", 2000), add("steel", 7200)};
    materials.policy.shear_dashpot =
        true; // the viscoelastic law of Dosta et al. (2024) damps both springs
    set_bulk_contacts(world, {});
    return numbers;
}

void set_bulk_contacts(World& world, const BulkContacts& contacts) {
    auto& materials = world.resource<Materials>();
    for (std::size_t k = 0; k < young_moduli.size(); ++k)
        materials.list[k].young_modulus = contacts.stiffness * young_moduli[k];
    for (const Pair& p : pairs)
        materials.set_pair(p.a, p.b,
                           {.friction = contacts.friction * p.friction,
                            .restitution = std::min(p.restitution, contacts.most_restitution)});
    materials.mix();
}

void BedState::save(Archive& archive) const {
    const std::array<double, 8> numbers{static_cast<double>(phase),
                                        static_cast<double>(stage),
                                        phase_began,
                                        kinetic_ratio,
                                        unbalanced_ratio,
                                        coordination,
                                        static_cast<double>(steps),
                                        time};
    archive.put("bed", std::span<const double>(numbers));
}

void BedState::load(const Archive& archive) {
    const auto n = archive.get<double>("bed");
    phase = static_cast<BedPhase>(n.at(0));
    stage = static_cast<unsigned>(n.at(1));
    phase_began = n.at(2);
    kinetic_ratio = n.at(3);
    unbalanced_ratio = n.at(4);
    coordination = n.at(5);
    steps = static_cast<std::uint64_t>(n.at(6));
    time = n.at(7);
}

void start_clock(World& world, double step) {
    Clock& clock = world.resource<Clock>();
    clock.block_step = clock.step;
    clock.block_time = 0;
    clock.dt = step;
}

BedMaker::BedMaker(Simulation& simulation, const BedSettings& settings)
    : simulation_(simulation), settings_(settings) {
    if (simulation.world().resource<Clock>().step == 0) enter(BedPhase::pour, 0);
}

BedState& BedMaker::state() { return simulation_.world().resource<BedState>(); }
const BedState& BedMaker::state() const {
    return std::as_const(simulation_).world().resource<BedState>();
}

// as a fraction of the stiffness of the run, which the last stage of hardening reaches
double BedMaker::stage_stiffness() const {
    switch (state().phase) {
    case BedPhase::pour:
        return softest(settings_);
    case BedPhase::harden:
        return std::min(1.0, softest(settings_) * std::pow(stage_factor, state().stage));
    default:
        return 1;
    }
}

void BedMaker::apply_phase() {
    World& world = simulation_.world();
    const double now = stage_stiffness();
    const bool making = state().phase < BedPhase::rest;
    set_bulk_contacts(
        world, {.stiffness = settings_.stiffness * now,
                .friction = making ? settings_.fill_friction : settings_.friction,
                .most_restitution = state().phase == BedPhase::harden ? damped_restitution : 1});
}

void BedMaker::enter(BedPhase phase, unsigned stage) {
    Clock& clock = simulation_.world().resource<Clock>();
    state().phase = phase;
    state().stage = stage;
    state().phase_began = clock.time();
    // at a given load the stiffness of a Hertz contact scales as E^(2/3), its period as E^(-1/3)
    clock.change_step(settings_.step / std::cbrt(stage_stiffness()));
    apply_phase();
}

void BedMaker::check_state() {
    const Quantities q = compute_quantities(simulation_.world());
    state().kinetic_ratio = q.kinetic_energy / (q.weight.norm() * mean_radius(simulation_.world()));
    state().unbalanced_ratio = q.unbalanced_ratio;
    state().coordination = q.coordination;
}

bool BedMaker::advance() {
    const Clock& clock = simulation_.world().resource<Clock>();
    if (state().phase == BedPhase::ready) return false;
    simulation_.advance(block);
    const double since = clock.time() - state().phase_began;
    if (state().phase == BedPhase::harden) {
        if (clock.step - clock.block_step < settings_.harden_steps) return true;
        if (stage_stiffness() < 1)
            enter(BedPhase::harden, state().stage + 1);
        else
            enter(BedPhase::rest, 0);
        return true;
    }
    if (clock.step % look_every != 0) return true;
    check_state();
    if (state().phase == BedPhase::pour) {
        // hardening turns overlaps into velocities again, so there is no use in waiting for rest
        const bool settled = since > settings_.least_pour &&
                             state().kinetic_ratio < 100 * settings_.kinetic_ratio &&
                             state().coordination > 3;
        if (settled || since > settings_.longest_pour) enter(BedPhase::harden, 0);
        return true;
    }
    if (!at_rest() && since <= settings_.longest_rest) return true;
    state().steps = clock.step;
    state().time = clock.time();
    state().phase = BedPhase::ready;
    return false;
}

bool BedMaker::at_rest() const {
    return state().kinetic_ratio < settings_.kinetic_ratio &&
           state().unbalanced_ratio < settings_.unbalanced_ratio;
}

// the lengths of pouring and resting are not known in advance
PhaseProgress BedMaker::progress() const {
    constexpr std::array names{"pour", "harden", "rest", "ready"};
    const double stages = std::ceil(-std::log(softest(settings_)) / std::log(stage_factor)) + 1;
    return {
        names[static_cast<std::size_t>(state().phase)],
        state().phase == BedPhase::harden ? state().stage / stages : -1,
        fmt::format(
            "{:.4f} s, kinetic ratio {:.2e}, unbalanced ratio {:.3f}, coordination number {:.2f}",
            std::as_const(simulation_).world().resource<Clock>().time(), state().kinetic_ratio,
            state().unbalanced_ratio, state().coordination)};
}

} // namespace bris

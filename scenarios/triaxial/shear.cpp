#include "components/body.hpp"
#include "components/material.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "engine/exact_sum.hpp"
#include "engine/ordering.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/triaxial/specimen_state.hpp"
#include "scenarios/triaxial/triaxial.hpp"
#include "systems/contact/energy_budget.hpp"
#include "systems/fusion/fuse.hpp"
#include "systems/output/balance.hpp"
#include "systems/output/porosity.hpp"
#include "systems/output/quantities.hpp"
#include "systems/output/stress.hpp"
#include "systems/servo/membrane.hpp"
#include "systems/servo/platen.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

namespace {

// strain rate * d * sqrt(density / mean stress), with d the mean size of the rocks and the density
// of their inertial (scaled) masses
double inertial_number_at(const World& world, const std::vector<Row>& rows, double rate,
                          double stress) {
    const Table& bodies = world.table<Bodies>();
    const auto mass = bodies.column<Mass>();
    const auto inertial = bodies.column<InertialMass>();
    const auto& materials = world.resource<Materials>();
    double all = 0, moving = 0;
    for (const Row r : rows) {
        if (!(mass[r] > 0)) continue;
        all += mass[r];
        moving += inertial[r];
    }
    const double density = materials.list[world.resource<Specimen>().rock_material].density;
    return rate * mean_size(world) * std::sqrt(density * moving / all / stress);
}

} // namespace

/// Adds the present state to the curves.
void TriaxialTest::add_stage() {
    const World& world = simulation_.world();
    const TriaxialState& s = state();
    const auto& membrane = world.resource<Membrane>();
    const Table& bodies = world.table<Bodies>();
    const auto rows = rows_by_id(bodies.column<BodyId>());
    const SpecimenLoad now = specimen_load(world);
    const double volume = now.volume;

    using namespace quantity;
    const auto p = simulation_.world().resource<TriaxialState>().curves.add_row();
    p[worst_ring_error] = p[mean_ring_error] = 0;
    for (const double pressure : membrane.pressure) {
        const double error = std::abs(pressure / membrane.target_pressure - 1);
        p[worst_ring_error] = std::max(p[worst_ring_error], error);
        p[mean_ring_error] += error / static_cast<double>(membrane.pressure.size());
    }
    const std::vector<double> radii = ring_radii(world);
    for (std::size_t r = 0; r < radii.size(); ++r) p.part(ring_radius, r) = radii[r];
    p[axial_stress] = now.axial_stress;
    p[radial_stress] = now.radial_stress;
    p[deviatoric_stress] = p[axial_stress] - p[radial_stress];
    p[axial_strain] = s.height > 0 ? 1 - now.height / s.height : 0;
    p[volumetric_strain] = s.volume > 0 ? 1 - volume / s.volume : 0;

    const Stresses stresses = compute_stresses(world);
    p[contact_stress_axial] = stresses.contact.axial / volume;
    p[contact_stress_radial] = stresses.contact.radial / volume;
    p[boundary_stress_axial] = stresses.boundary.axial / volume;
    p[boundary_stress_radial] = stresses.boundary.radial / volume;

    const Quantities q = compute_quantities(world);
    p[unbalanced_ratio] = q.unbalanced_ratio;
    p[coordination_number] = q.coordination;
    p[stored_energy] = q.elastic_energy + potential_energy(world);
    p[kinetic_energy] = q.kinetic_energy;
    p[boundary_work] = exact_sum(bodies.column<BoundaryWork>());
    p[friction_work] = dissipated_in_contacts(world);
    p[damping_work] = exact_sum(bodies.column<DampingWork>());
    p[scaling_work] = exact_sum(bodies.column<ScalingWork>());
    p[steps] = static_cast<double>(s.phase_steps);
    const bool shears = s.phase == TriaxialPhase::shear && s.phase_steps > 0;
    const double rate =
                     settings_.stage_strain / (settings_.move_steps * world.resource<Clock>().dt),
                 mean_stress = (p[axial_stress] + 2 * p[radial_stress]) / 3;
    p[quantity::inertial_number] = shears ? inertial_number_at(world, rows, rate, mean_stress) : 0;
}

// Moves the platen by one stage, from rest to rest: a sudden start would send a wave through the
// specimen.
void TriaxialTest::move_platen() {
    World& world = simulation_.world();
    auto& platen = world.resource<Platen>();
    constexpr unsigned parts = ramp_parts;
    const std::uint64_t steps = settings_.move_steps / parts;
    const double mean = settings_.stage_strain * state().height /
                        (static_cast<double>(parts * steps) * world.resource<Clock>().dt);
    for (unsigned k = 0; k < parts; ++k) {
        platen.speed = mean * (1 - std::cos(2 * pi * (k + 0.5) / parts));
        run(steps);
    }
    platen.speed = 0;
}

// Assimilates the observations that have arrived by this strain; the stage then has to come to rest
// again. False: there are none, all are rejected, or they have been assimilated already.
bool TriaxialTest::analyse() {
    World& world = simulation_.world();
    if (!world.has_resource<Fusion>()) return false;
    auto& fusion = world.resource<Fusion>();
    fusion.strain = static_cast<double>(state().stage + 1) * settings_.stage_strain;
    if (!fusion_is_due(world) || dismiss_samples(world)) return false;
    run(1 + fusion.injection_steps);
    return true;
}

void TriaxialTest::shear() {
    World& world = simulation_.world();
    auto& state = world.resource<TriaxialState>();
    const auto stages = static_cast<std::uint64_t>(
        std::llround(settings_.final_axial_strain / settings_.stage_strain));
    if (state.stage >= stages) {
        state.phase = TriaxialPhase::done;
        return;
    }
    if (state.phase_steps == 0) {
        if (world.has_resource<Fusion>()) hold_nudging_forces(world);
        move_platen();
    }
    run(20);
    if (is_in_equilibrium()) {
        if (analyse()) return;
        ++state.stage;
        add_stage();
        state.phase_steps = 0;
        rescale();
        return;
    }
    if (state.phase_steps % 200 < 20) keep_stable();
    if (state.phase_steps > settings_.longest_stage)
        throw SimulationError(fmt::format(
            "stage {} (axial strain {:.4f}): no equilibrium after {} steps: {}", state.stage + 1,
            static_cast<double>(state.stage + 1) * settings_.stage_strain, state.phase_steps,
            equilibrium_status()));
}

} // namespace bris

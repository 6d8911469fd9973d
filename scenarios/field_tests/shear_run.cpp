// Consolidation and shear of a made specimen in the shear box.
#include "components/fouling.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/clock.hpp"
#include "engine/errors.hpp"
#include "engine/exact_sum.hpp"
#include "engine/ordering.hpp"
#include "scenarios/field_tests/grains.hpp"
#include "scenarios/field_tests/shear_box.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/energy_budget.hpp"
#include "systems/contact/mass_scaling.hpp"
#include "systems/fields/fouling.hpp"
#include "systems/loads/table.hpp"
#include "systems/output/balance.hpp"
#include "systems/output/quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr std::uint64_t block = 100, longest_consolidation = 300'000, least_consolidation = 3000;
constexpr double ramp = 0.01;  // s, of the load
constexpr unsigned parts = 10; // of an interval between samples, over which forces are averaged

/// Forces of the rocks on the box, N.
struct BoxForces {
    Vec3 lower = Vec3::Zero(); ///< on sides, flange and floor of the lower half
    Vec3 upper = Vec3::Zero(); ///< on sides and flange of the upper half and on its plate
    double plate = 0;          ///< upwards on the plate
    double below = 0;          ///< weight of the rocks below the plane between the halves
    double weight = 0;         ///< weight of all rocks
};

BoxForces forces_of(const World& world, double plane) {
    const auto& halves = world.resource<BoxHalves>();
    const auto& bed = world.resource<RockBed>();
    BoxForces f;
    f.lower = contact_force(world, halves.lower) + contact_force(world, halves.floor);
    const Vec3 on_plate = contact_force(world, bed.plate);
    f.upper = contact_force(world, halves.upper) + on_plate;
    f.plate = on_plate.z();
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto mass = world.column<Bodies, Mass>();
    const auto position = world.column<Bodies, Position>();
    const double g = -world.resource<Gravity>().value.z();
    const auto weigh = [&](EntityId id) {
        f.weight += g * mass[rows[id]];
        if (position[rows[id]].z() < plane) f.below += g * mass[rows[id]];
    };
    std::ranges::for_each(bed.rocks, weigh);
    for (auto id = bed.first_grain; id < rows.size(); ++id) weigh(id);
    return f;
}

struct Energies {
    double put_in = 0, stored = 0, lost = 0; // J
};

/// Energies since the start: work of boundary, elements and mass scaling; elastic, kinetic and
/// potential energy; work of friction and dashpots.
Energies energies_of(const World& world, const Quantities& q) {
    const Table& bodies = world.table<Bodies>();
    Energies e;
    const ElementWork elements = work_of_elements(world);
    e.put_in = exact_sum(bodies.column<BoundaryWork>()) + elements.done +
               exact_sum(bodies.column<ScalingWork>());
    e.lost = dissipated_in_contacts(world) + elements.lost;
    e.stored = q.elastic_energy + q.kinetic_energy + potential_energy(world);
    return e;
}

/// Speed over the thickness of a shear zone of five mean rocks, times d sqrt(density / stress).
double inertial_number(const World& world, const ShearBox& box, double stress) {
    const auto& bed = world.resource<RockBed>();
    const double density = world.resource<Materials>().list[bed.rock].density;
    return box.speed / 5 * std::sqrt(density / std::max(stress, 1.0));
}

void add_sample(const World& world, const ShearBox& box, const BoxForces& f,
                SeriesOf<ShearSample>& curve) {
    const auto& state = world.resource<ShearState>();
    const Quantities q = compute_quantities(world);
    const Energies e = energies_of(world, q);
    const double area = box.area(), shear = 0.5 * (f.upper.x() - f.lower.x()),
                 applied = f.plate + f.weight - f.below, normal = -f.lower.z() - f.below;
    curve.add({.displacement = state.displacement,
               .shear_stress = shear / area,
               .normal_stress = applied / area,
               .stress_ratio = shear / applied,
               .plane_normal_stress = normal / area,
               .dilation = plate_height(world) - state.start_height,
               .shear_force_lower_half = -f.lower.x(),
               .shear_force_upper_half = f.upper.x(),
               .normal_force_lower_half = -f.lower.z(),
               .normal_force_upper_half = f.upper.z(),
               .weight_of_rocks = f.weight,
               .work_put_in = e.put_in,
               .energy_stored = e.stored,
               .work_lost = e.lost,
               .kinetic_energy = q.kinetic_energy,
               .coordination_number = q.coordination,
               .unbalanced_ratio = q.unbalanced_ratio,
               .inertial_number = inertial_number(world, box, normal / area)});
}

Phase consolidate(const ShearBox& box, const ShearTest& test, SeriesOf<ShearSample>& curve,
                  const std::function<void(const World&)>& frame) {
    return {
        .advance =
            [&box, test, &curve, frame](Simulation& s) {
                World& world = s.world();
                auto& state = world.resource<ShearState>();
                s.advance(block);
                state.steps += static_cast<double>(block);
                rescale_masses(world, box.safety);
                const auto& bed = world.resource<RockBed>();
                const double pushed = contact_force(world, bed.plate).z() / box.area(),
                             error = std::abs(pushed / test.normal_stress - 1),
                             unbalanced = compute_balance(world).unbalanced_ratio;
                if (state.steps >= least_consolidation && error < 0.01 &&
                    unbalanced < box.tolerance) {
                    state.start_height = plate_height(world);
                    state.start_vci = contaminant_index(world, box);
                    add_sample(world, box, forces_of(world, box.plane()), curve);
                    frame(world);
                    return false;
                }
                if (state.steps > longest_consolidation)
                    throw SimulationError(fmt::format(
                        "consolidation: expected rest under {:.4g} kPa, found {:.4g} kPa and an "
                        "unbalanced force ratio of {:.1e} after {:.0f} steps",
                        1e-3 * test.normal_stress, 1e-3 * pushed, unbalanced, state.steps));
                return true;
            },
        .progress =
            [test](const World& world) {
                return PhaseProgress{"consolidate", -1,
                                     fmt::format("{:.0f} kPa, unbalanced force ratio {:.1e}",
                                                 1e-3 * test.normal_stress,
                                                 compute_balance(world).unbalanced_ratio)};
            },
        .begin =
            [&box, test](Simulation& s) {
                World& world = s.world();
                world.resource<ShearState>() = {};
                world.resource<Limits>().overlap = Limits{}.overlap;
                ramp_plate(world, test.normal_stress * box.area(), ramp);
            }};
}

/// The space of the fines follows the halves and the plate, in steps of half a voxel so that the
/// fields need not be computed anew for each sample.
void move_fields(World& world, const ShearBox& box) {
    if (!world.has_resource<Fouling>()) return;
    auto& fouling = world.resource<Fouling>();
    const double moved = world.resource<ShearState>().displacement, x = 0.5 * box.length,
                 step = 0.5 * fouling.settings.voxel, y = box.width, low = -box.height,
                 high = 3 * box.height, top = plate_height(world);
    const double left = std::floor(moved / step) * step, right = left + step;
    if (fouling.box.high.x() == x + right && std::abs(fouling.box.high.z() - top) < step) return;
    fouling.box.high = Vec3(x + right, 0.5 * box.width, top + step);
    fouling.blocked = {{Vec3(-x, -y, low), Vec3(-x + left, y, box.plane())},
                       {Vec3(x, -y, box.plane()), Vec3(x + right, y, high)}};
}

void drive_lower_half(World& world, double speed) {
    const auto& halves = world.resource<BoxHalves>();
    for (const EntityId body : {halves.lower, halves.floor}) {
        value_of<MotionOf>(world, body) = static_cast<std::uint32_t>(Motion::prescribed);
        value_of<DriveVelocity>(world, body) = Vec3(speed, 0, 0);
    }
    invalidate_lists(world);
}

Phase shear(const ShearBox& box, const ShearTest& test, SeriesOf<ShearSample>& curve,
            const std::function<void(const World&)>& frame) {
    const auto samples = static_cast<std::uint64_t>(std::llround(box.displacement / box.interval));
    return {
        .advance =
            [&box, &curve, frame, samples](Simulation& s) {
                World& world = s.world();
                auto& state = world.resource<ShearState>();
                const auto& halves = world.resource<BoxHalves>();
                if (curve.rows() > samples) return false;
                const double dt = world.resource<Clock>().dt;
                const auto part = static_cast<std::uint64_t>(
                    std::max(1.0, std::round(box.interval / (box.speed * dt * parts))));
                BoxForces mean;
                for (unsigned k = 0; k < parts; ++k) {
                    s.advance(part);
                    const BoxForces f = forces_of(world, box.plane());
                    mean.lower += f.lower / parts;
                    mean.upper += f.upper / parts;
                    mean.plate += f.plate / parts;
                    mean.below += f.below / parts;
                    mean.weight = f.weight;
                }
                check_stable_step(world);
                (void)scale_masses(world, dt, box.safety, true);
                state.displacement = value_of<Position>(world, halves.lower).x();
                add_sample(world, box, mean, curve);
                move_fields(world, box);
                const std::uint64_t done = curve.rows() - 1;
                if (done * 10 / samples != (done - 1) * 10 / samples) frame(world);
                return done < samples;
            },
        .progress =
            [&box, test, &curve, samples](const World& world) {
                const double ratio = curve[&ShearSample::stress_ratio].back();
                return PhaseProgress{
                    "shear", static_cast<double>(curve.rows() - 1) / static_cast<double>(samples),
                    fmt::format("{:.0f} kPa, VCI {:g} %: {:.1f} of {:g} mm, stress ratio {:.2f}",
                                1e-3 * test.normal_stress, test.vci,
                                1e3 * world.resource<ShearState>().displacement,
                                1e3 * box.displacement, ratio),
                    static_cast<double>(curve.rows())};
            },
        .begin = [&box](Simulation& s) { drive_lower_half(s.world(), box.speed); }};
}

} // namespace

std::vector<Phase> shear_phases(const ShearBox& box, const ShearTest& test,
                                SeriesOf<ShearSample>& curve,
                                const std::function<void(const World&)>& frame) {
    std::vector<Phase> phases;
    if (box.fines == "grains") phases.push_back(grow_grains(box.fines_size, box.safety));
    phases.push_back(consolidate(box, test, curve, frame));
    phases.push_back(shear(box, test, curve, frame));
    return phases;
}

} // namespace bris

#include "scenarios/field_tests/rock_bed.hpp"

#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/clock.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "engine/random_vector.hpp"
#include "scenarios/rocks/own_rocks.hpp"
#include "scenarios/specimens/equilibrium.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/growth.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/specimen.hpp"
#include "scenarios/specimens/sphere_cells.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/mass_scaling.hpp"
#include "systems/output/balance.hpp"
#include "systems/output/porosity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace bris {

namespace {

constexpr double filled_porosity = 0.58; // of the mould in which rocks grow
constexpr std::uint64_t growth_block = 20, patience = 20'000, press_block = 50,
                        porosity_steps = 250;
// dashpots of a low restitution lower the stable step, which the scaling of masses does not count
constexpr double making_safety = 0.45, making_restitution = 0.3;
constexpr double quasi_static = 0.02, pressure_error = 0.05; // while friction is reduced
constexpr double friction_left = 0.99, least_friction = 5e-3;
constexpr std::uint64_t placing_stream = 2001, turning_stream = 1002;

/// Speed (m/s) at which the plate sinks while no rock holds it, and damping (N s/m3) in a test.
constexpr double sinking_speed = 0.3, test_damping = 2000;

/// Springs that leave the plate no motion but that along z, and a dashpot along z.
void guide_plate(World& world, EntityId plate) {
    constexpr double stiffness = 5e7, damping = 2e3; // N/m, N s/m
    const auto guide = [&](const Vec3& point, const Vec3& axis) {
        add_guide(world, plate, point, axis, stiffness, damping);
    };
    for (const double end : {-1.0, 1.0}) {
        guide(Vec3(0, end, 0), Vec3::UnitX()); // also no rotation about z
        guide(Vec3(0, 0, end), Vec3::UnitX()); // about y
        guide(Vec3(0, 0, end), Vec3::UnitY()); // about x
    }
    add_patch(world, plate, {.anchor = value_of<Position>(world, plate), .axis = Vec3::UnitZ()});
}

/// Sets the dashpot along z, the last patch of plate and tie, in N s/m2.
void damp(World& world, double of_area) {
    const auto& bed = world.resource<RockBed>();
    auto& patches = world.resource<SpringPatches>().of_body;
    patches[value_of<PatchesOf>(world, bed.plate) - 1].back().damping = of_area * bed.plate_area();
    if (bed.tie == nobody) return;
    patches[value_of<PatchesOf>(world, bed.tie) - 1].back().damping = of_area * bed.tie_area;
}

void add_plate(World& world, RockBed& bed, double overhang) {
    const Vec3 size(bed.settings.size.x() + 2 * overhang, bed.settings.size.y() + 2 * overhang,
                    plate_thickness);
    bed.plate = add_block(world, Vec3(0, 0, bed.lid + 0.5 * plate_thickness),
                          Quat(Quat::Identity()), size, plate_mass, bed.rock);
    guide_plate(world, bed.plate);
    add_load(world, bed.plate, {.force = Vec3(0, 0, -1), .history = {.mean = 0}});
    value_of<MotionOf>(world, bed.plate) = static_cast<std::uint32_t>(Motion::fixed);
}

LoadHistory& plate_load(World& world) {
    const EntityId plate = world.resource<RockBed>().plate;
    return world.resource<Loads>().of_body[value_of<LoadOf>(world, plate) - 1].front().history;
}

/// Places all rocks at random below the lid, clear of each other at `first_scale`.
void place_rocks(World& world) {
    const auto& bed = world.resource<RockBed>();
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto position = world.column<Bodies, Position>();
    const auto motion = world.column<Bodies, MotionOf>();
    const auto radius = world.column<Bodies, BoundingRadius>();
    std::vector<EntityId> order = bed.rocks; // largest first
    std::ranges::sort(order, [&](EntityId a, EntityId b) {
        return radius[rows[a]] != radius[rows[b]] ? radius[rows[a]] > radius[rows[b]] : a < b;
    });
    const Vec3 tie = bed.tie == nobody ? Vec3(Vec3::Zero()) : value_of<Position>(world, bed.tie);
    SphereCells filled(first_scale * radius[rows[order.front()]]);
    for (const EntityId id : order) {
        Random random(bed.settings.seed, placing_stream + id);
        double size = first_scale * radius[rows[id]];
        for (int attempt = 1;; ++attempt) {
            if (attempt % 500 == 0) size *= 0.97; // little room: bounding spheres may overlap
            const Vec3 half = 0.5 * bed.settings.size - Vec3::Constant(size);
            const Vec3 x = place_in_box(random, Vec3(-half.x(), -half.y(), size),
                                        Vec3(half.x(), half.y(), bed.lid - size));
            if (bed.tie != nobody) {
                Vec3 outside = (x - tie).cwiseAbs() - 0.5 * bed.tie_size;
                // above the tie a rock would have no room to grow below the lid
                if (x.z() > tie.z()) outside.z() = 0;
                if (outside.cwiseMax(0).norm() < size) continue;
            }
            if (!filled.is_clear(x, size)) continue;
            position[rows[id]] = x;
            filled.add(x, size);
            break;
        }
        motion[rows[id]] = static_cast<std::uint32_t>(Motion::free);
    }
}

void stop_rocks(World& world) {
    for (const EntityId id : world.resource<RockBed>().rocks) {
        value_of<Velocity>(world, id).setZero();
        value_of<Acceleration>(world, id).setZero();
        set_angular_velocity(world, id, Vec3::Zero());
    }
}

Phase grow() {
    return {.advance =
                [](Simulation& s) {
                    World& world = s.world();
                    s.advance(growth_block);
                    auto& state = world.resource<RockBedState>();
                    state.steps += static_cast<double>(growth_block);
                    const auto& rocks = world.resource<RockBed>().rocks;
                    const bool grown =
                        grow_rocks(world, rocks, largest_overlaps(world),
                                   1 + growth_per_step * static_cast<double>(growth_block),
                                   squeezing_limit * (1 + std::floor(state.steps / patience)));
                    if (!grown && state.steps > static_cast<double>(
                                                    world.resource<RockBed>().settings.longest))
                        throw SimulationError(fmt::format(
                            "filling: the mould has no room for its rocks after {:.0f} steps",
                            state.steps));
                    rescale_masses(world, making_safety);
                    return !grown;
                },
            .progress =
                [](const World& world) {
                    double size = 0;
                    const auto& rocks = world.resource<RockBed>().rocks;
                    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
                    for (const EntityId id : rocks)
                        size += world.column<Bodies, Growth>()[rows[id]];
                    size /= static_cast<double>(rocks.size());
                    return PhaseProgress{"filling", (size - first_scale) / (1 - first_scale), ""};
                },
            .begin =
                [](Simulation& s) {
                    World& world = s.world();
                    world.resource<RockBedState>() = {};
                    world.resource<Gravity>().value.setZero();
                    set_contacts(world, 0, making_restitution);
                    forget_lists(world); // bodies know the rows of their spheres from here on
                    place_rocks(world);
                    const auto& rocks = world.resource<RockBed>().rocks;
                    for (const EntityId id : rocks) value_of<Growth>(world, id) = first_scale;
                    resize_rocks(world, rocks);
                    rescale_masses(world, making_safety);
                }};
}

/// Reduces friction where the bed is at rest, and decides whether it is made; see RockBed.
bool settle_on(World& world) {
    const auto& bed = world.resource<RockBed>();
    const RockBedSettings& wanted = bed.settings;
    auto& state = world.resource<RockBedState>();
    if (static_cast<std::uint64_t>(state.steps) % porosity_steps == 0)
        state.porosity = bed_porosity(world);
    if (state.poured > 0 && state.porosity <= wanted.porosity) return true;
    const double pushed =
        contact_force(world, bed.plate).z() / (wanted.pressure * bed.plate_area());
    if (state.steps < 2000 || std::abs(pushed - 1) > pressure_error ||
        compute_balance(world).unbalanced_ratio > quasi_static)
        return false;
    if (state.poured == 0) {
        state.poured = state.porosity = bed_porosity(world);
        if (state.poured < wanted.porosity - wanted.tolerance)
            throw SimulationError(fmt::format(
                "--porosity: expected at most {:.3f}, that of these rocks as poured, found {:g}",
                state.poured, wanted.porosity));
    }
    if (state.friction == 0) {
        state.porosity = bed_porosity(world);
        if (state.porosity <= wanted.porosity + wanted.tolerance) return true;
        throw SimulationError(fmt::format("--porosity: expected at least {:.3f}, that of these "
                                          "rocks without friction, found {:g}",
                                          state.porosity, wanted.porosity));
    }
    state.friction *= friction_left;
    if (state.friction < least_friction) state.friction = 0;
    set_contacts(world, state.friction, making_restitution);
    return false;
}

Phase press() {
    return {
        .advance =
            [](Simulation& s) {
                World& world = s.world();
                auto& state = world.resource<RockBedState>();
                if (state.made > 0) return false;
                s.advance(press_block);
                state.steps += static_cast<double>(press_block);
                const auto& bed = world.resource<RockBed>();
                if (settle_on(world)) {
                    set_contacts(world, bed.friction, bed.restitution);
                    damp(world, test_damping);
                    state.made = 1;
                }
                if (state.steps > static_cast<double>(bed.settings.longest))
                    throw SimulationError(fmt::format(
                        "pressing: expected rest under {:.3g} kPa and a core porosity of {:.3f}, "
                        "found a porosity of {:.3f} with friction {:.3f} after {:.0f} steps",
                        1e-3 * bed.settings.pressure, bed.settings.porosity, state.porosity,
                        state.friction, state.steps));
                rescale_masses(world, making_safety);
                return state.made == 0;
            },
        .progress =
            [](const World& world) {
                const auto& state = world.resource<RockBedState>();
                return PhaseProgress{"pressing", -1,
                                     fmt::format("friction {:.3f}, core porosity {:.3f}",
                                                 state.friction, state.porosity)};
            },
        .begin =
            [](Simulation& s) {
                World& world = s.world();
                const auto& bed = world.resource<RockBed>();
                world.resource<RockBedState>() = {.friction = bed.friction};
                world.resource<Gravity>().value = Vec3(0, 0, -9.81);
                stop_rocks(world);
                set_contacts(world, bed.friction, making_restitution);
                value_of<MotionOf>(world, bed.plate) = static_cast<std::uint32_t>(Motion::free);
                if (bed.tie != nobody) {
                    value_of<MotionOf>(world, bed.tie) = static_cast<std::uint32_t>(Motion::free);
                    press_tie(world, bed.settings.pressure);
                }
                press_plate(world, bed.settings.pressure * bed.plate_area());
                damp(world, bed.settings.pressure / sinking_speed);
                invalidate_lists(world);
                rescale_masses(world, making_safety);
            }};
}

} // namespace

RockSample sample_of_volume(const BedRocks& rocks, const std::vector<Clump>& clumps, double volume,
                            std::uint64_t seed) {
    const Grading grading = grading_named(rocks.grading);
    const double cubed = std::pow(rocks.scale, 3);
    require_countable(grading, clumps, volume / cubed, rocks.smallest, "--smallest-rock");
    std::size_t count = 1000;
    RockSample sample;
    for (int tries = 0; tries < 4; ++tries) { // the mean volume hardly depends on the number
        sample = sample_rocks(grading, clumps, count, seed, rocks.smallest);
        const double found = cubed * sample.solid_volume;
        count = static_cast<std::size_t>(
            std::max(8.0, std::round(static_cast<double>(count) * volume / found)));
    }
    for (RockChoice& rock : sample.rocks) rock.sieve *= rocks.scale;
    sample.solid_volume *= cubed;
    return sample;
}

void add_rock_bed(World& world, const RockBedSettings& settings, const std::vector<Clump>& clumps,
                  const RockSample& sample, std::uint32_t rock, double overhang) {
    RockBed bed{.settings = settings, .rock = rock};
    const Material& material = world.resource<Materials>().list[rock];
    bed.friction = material.friction;
    bed.restitution = material.restitution;
    Specimen shapes; // by which rocks grow
    shapes.clumps = clumps;
    shapes.scale.assign(world.table<Bodies>().size(), 1.0);
    Random random(settings.seed, turning_stream);
    for (const RockChoice& choice : sample.rocks) {
        const double scale = choice.sieve / clumps[choice.clump].sieve;
        const auto k = bed.rocks.size();
        const Vec3 parked(0.3 * static_cast<double>(k % 8) - 1.2,
                          0.3 * static_cast<double>(k / 8 % 8) - 1.2,
                          -0.5 - 0.3 * static_cast<double>(k / 64));
        bed.rocks.push_back(add_clump(world, scaled(clumps[choice.clump], scale),
                                      static_cast<std::uint32_t>(choice.clump), parked,
                                      random.rotation(), rock, Motion::fixed));
        shapes.scale.push_back(scale);
        bed.solid_volume += value_of<Mass>(world, bed.rocks.back()) / material.density;
        bed.mean_size += choice.sieve / static_cast<double>(sample.rocks.size());
        bed.largest_size = std::max(bed.largest_size, choice.sieve);
    }
    bed.lid = bed.solid_volume / (1 - filled_porosity) / bed.area();
    add_plate(world, bed, overhang);
    auto& limits = world.resource<Limits>();
    limits.overlap = 0.5; // rocks are squeezed while they grow
    limits.low = Vec3(-2, -2, -0.6 - 0.3 * static_cast<double>(bed.rocks.size() / 64 + 1));
    limits.high = Vec3(2, 2, bed.lid + 1);
    world.table<Bodies>().add<Growth>();
    world.add_resource<Gravity>();
    world.add_resource(std::move(shapes));
    world.add_resource(std::move(bed));
    world.add_resource<RockBedState>();
}

void add_tie(World& world, EntityId tie, const Vec3& size, double volume) {
    auto& bed = world.resource<RockBed>();
    bed.tie = tie;
    bed.tie_size = size;
    bed.tie_area = volume / size.z();
    const double raised = volume / bed.area();
    bed.lid += raised;
    value_of<Position>(world, bed.plate).z() += raised;
    add_patch(world, tie, {.anchor = value_of<Position>(world, tie), .axis = Vec3::UnitZ()});
    add_load(world, tie, {.force = Vec3(0, 0, -1), .history = {.mean = 0}});
    value_of<MotionOf>(world, tie) = static_cast<std::uint32_t>(Motion::fixed);
}

std::vector<Phase> make_bed_phases() { return {grow(), press()}; }

void set_contacts(World& world, double friction, double restitution) {
    auto& materials = world.resource<Materials>();
    const auto& bed = world.resource<RockBed>();
    materials.list[bed.rock].friction = friction;
    for (Material& material : materials.list)
        material.restitution = std::min(restitution, bed.restitution);
    materials.mix();
}

void rescale_masses(World& world, double safety) {
    world.resource<Clock>().change_step(scale_masses(world, 0, safety, false).dt);
}

void press_plate(World& world, double force) {
    plate_load(world) = {.mean = force - plate_mass * 9.81};
}

void press_tie(World& world, double pressure) {
    const auto& bed = world.resource<RockBed>();
    world.resource<Loads>().of_body[value_of<LoadOf>(world, bed.tie) - 1].front().history = {
        .mean = pressure * bed.tie_area};
}

void ramp_plate(World& world, double force, double duration) {
    const double now = world.resource<Clock>().time(), before = plate_load(world).at(now);
    plate_load(world) = {.times = {now, now + duration},
                         .values = {before, force - plate_mass * 9.81}};
}

double plate_height(const World& world) {
    const Row row = row_of_body(world, world.resource<RockBed>().plate);
    return world.column<Bodies, Position>()[row].z() - 0.5 * plate_thickness;
}

double bed_porosity(const World& world) {
    constexpr double pitch = 4e-3; // m, of lines along which it is integrated
    const auto& wanted = world.resource<RockBed>().settings;
    if (wanted.core_low != wanted.core_high)
        return porosity(world, BoxRegion{wanted.core_low, wanted.core_high}, pitch);
    const double top = plate_height(world);
    return porosity(
        world, {0.3 * std::min(wanted.size.x(), wanted.size.y()), 0.25 * top, 0.75 * top}, 120);
}

} // namespace bris

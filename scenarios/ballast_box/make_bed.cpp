// Phases of a box in which its bed of ballast is made.
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "scenarios/ballast_box/box_run.hpp"
#include "scenarios/ballast_box/pour.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/true_masses.hpp"
#include "systems/contact/mass_scaling.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/fields/fouling.hpp"
#include "systems/output/porosity.hpp"
#include "systems/output/quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

/// Time step over the stable step without the dashpots, which are strong here.
constexpr double making_safety = 0.4;
constexpr double stage_factor = 1.25; // of hardening
constexpr std::uint64_t stage_steps = 300;
// of compaction
constexpr double ramp = 0.05, kneading = 0.1, longest = 2; // s
constexpr double frequency = 30;                           // Hz, of the plate
constexpr double friction_left = 0.97, least_friction = 5e-3;
constexpr double tolerance = 0.01;  // of porosity, once no friction is left
constexpr double line_pitch = 4e-3; // m, of the lines on which porosity is measured
enum CompactionStage : int { pressing, compacting, kneaded, lifting };

/// Dashpots of the subgrade for a quasi-static run: a ratio of critical damping of the mode in
/// which a scaled mass (kg) moves on all springs together.
void damp_subgrade(World& world, double mass) {
    constexpr double ratio = 0.3;
    double stiffness = 0, springs = 0;
    const auto for_vertical = [&](auto&& visit) {
        for (const EntityId plate : world.resource<BoxBodies>().subgrade)
            for (SpringPatch& p :
                 world.resource<SpringPatches>().of_body[value_of<PatchesOf>(world, plate) - 1])
                if (p.axis.z() > 0.5) visit(p);
    };
    for_vertical([&](const SpringPatch& p) {
        stiffness += p.stiffness;
        ++springs;
    });
    for_vertical(
        [&](SpringPatch& p) { p.damping = 2 * ratio * std::sqrt(stiffness * mass) / springs; });
}

/// Gives rocks the masses with which all of them have the same stable step, since the smallest ones
/// would ask for a step of a third. Weights follow the masses, so that all fall alike. With dt = 0
/// (s) the step is chosen so that the total mass stays; otherwise masses are only raised.
double scale_rocks(World& world, double dt) {
    const MassScaling scaling = scale_masses(world, dt, making_safety, dt > 0);
    const EntityId first = world.resource<BoxBodies>().sensors.front().body; // rocks follow
    Table& bodies = world.table<Bodies>();
    for (Row b = 0; b < bodies.size(); ++b) {
        if (bodies.column<BodyId>()[b] < first) continue;
        bodies.column<Mass>()[b] = bodies.column<InertialMass>()[b];
        bodies.column<Inertia>()[b] = bodies.column<InertialInertia>()[b];
    }
    return scaling.dt;
}

double kinetic_ratio(const World& world) {
    const Quantities q = compute_quantities(world);
    return q.kinetic_energy / (q.weight.norm() * mean_radius(world));
}

} // namespace

void BoxTestRun::take_true_masses(World& world) const {
    const World as_made = make_box_world(box_, seed_); // whose rows are in the order of the ids
    Table& bodies = world.table<Bodies>();
    for (Row b = 0; b < bodies.size(); ++b) {
        const EntityId id = bodies.column<BodyId>()[b];
        bodies.column<Mass>()[b] = as_made.column<Bodies, Mass>()[id];
        bodies.column<Inertia>()[b] = as_made.column<Bodies, Inertia>()[id];
    }
    adapt_step(world, making_fraction * restore_masses(world));
}

Phase BoxTestRun::pour(std::size_t course) const {
    constexpr double least = 0.25, most = 0.8; // s
    return {.advance =
                [this](Simulation& s) {
                    s.advance(block);
                    scale_rocks(s.world(), s.world().resource<Clock>().dt);
                    const double now = since(s.world());
                    return now < least || (now < most && kinetic_ratio(s.world()) > 1e-2);
                },
            .progress =
                [course](const World& world) {
                    return PhaseProgress{fmt::format("pour course {}", course + 1),
                                         since(world) / most, ""};
                },
            .begin =
                [this, course](Simulation& s) {
                    note_beginning(s.world());
                    if (course == 1) place_bladder(s.world(), sizes_);
                    if (course > 0) add_course(s.world(), course, seed_);
                    pour_course(s.world(), sizes_, course, seed_);
                    s.world().resource<Clock>().change_step(scale_rocks(s.world(), 0));
                }};
}

double BoxTestRun::porosity_between(const World& world, double low, double high) const {
    const double radius = mean_radius(world), aside = std::min(2 * radius, sizes_.width / 4);
    return porosity(world,
                    BoxRegion{.low = Vec3(aside, aside, low + radius),
                              .high = Vec3(sizes_.width - aside, sizes_.bladder_face() - aside,
                                           std::max(high - radius, low + 1.1 * radius))},
                    line_pitch);
}

const std::vector<CompactionPlate>& BoxTestRun::plates_of(const World& world, std::size_t lift) {
    return world.resource<BoxBodies>().plates[lift == 0 ? 0 : 1];
}

double BoxTestRun::plates_height(const World& world, std::size_t lift) {
    const auto& plates = plates_of(world, lift);
    double height = 0;
    for (const CompactionPlate& plate : plates)
        height += world.column<Bodies, Position>()[row_of_body(world, plate.body)].z();
    return height / static_cast<double>(plates.size()) - plate_thickness / 2;
}

void BoxTestRun::load_plates(World& world, std::size_t lift, const LoadHistory& history) const {
    for (const CompactionPlate& plate : plates_of(world, lift))
        set_load(world, plate.body, history);
}

double BoxTestRun::porosity_of_lift(const World& world, std::size_t lift) const {
    const auto& state = world.resource<BoxState>();
    const double radius = mean_radius(world),
                 // the first lift ends at the floor, the others within the one below
        low = lift == 0 ? 0 : state.surface[lift - 1] - 2 * radius,
                 top = plates_height(world, lift);
    return porosity_between(world, low, top);
}

void BoxTestRun::begin_compaction(World& world, std::size_t lift) const {
    note_beginning(world);
    auto& state = world.resource<BoxState>();
    state.stage = pressing;
    state.friction = 1;
    for (const CompactionPlate& plate : plates_of(world, lift)) {
        Vec3 at = value_of<Position>(world, plate.body);
        at.z() = surface_height(world, plate.low, plate.high, 0) + plate_thickness / 2 + 1e-3;
        release(world, plate.body, at);
    }
    const double start = world.resource<Clock>().time();
    load_plates(world, lift,
                {.times = {start, start + ramp}, .values = {0, plate_force(world, lift)}});
}

double BoxTestRun::plate_force(const World& world, std::size_t lift) const {
    return box_.compaction_pressure * sizes_.width *
           (lift == 0 ? sizes_.across : sizes_.bladder_face()) /
           static_cast<double>(plates_of(world, lift).size());
}

// The plate presses the lift down and oscillates. With their friction the rocks stay as loose as
// they were poured; so friction is reduced until the lift is as dense as wanted. Then the plate
// goes on with full friction, whose contacts replace those that formed with little.
bool BoxTestRun::compact_further(World& world, std::size_t lift) const {
    auto& state = world.resource<BoxState>();
    const double now = world.resource<Clock>().time(), force = plate_force(world, lift);
    const auto go_on = [&](CompactionStage stage) {
        state.stage = stage;
        state.began = now;
    };
    const auto stage = static_cast<int>(state.stage);
    if (stage == pressing && since(world) >= ramp) {
        load_plates(
            world, lift,
            {.mean = force, .amplitude = 0.6 * force, .frequency = frequency, .start = now});
        go_on(compacting);
    } else if (stage == compacting) {
        state.porosity[lift] = porosity_of_lift(world, lift);
        const bool done =
            state.porosity[lift] <= box_.porosity + (state.friction > 0 ? 0 : tolerance);
        if (!done && since(world) > longest)
            throw SimulationError(fmt::format(
                "lift {}: expected a porosity of at most {:g} after compaction, found {:.4f} after "
                "{:g} s under the plate, without friction at the end; choose a larger --porosity "
                "or --compaction-pressure",
                lift + 1, box_.porosity + tolerance, state.porosity[lift], since(world)));
        state.friction *= friction_left;
        if (state.friction < least_friction) state.friction = 0;
        if (done) {
            state.friction = 1;
            go_on(kneaded);
        }
        set_materials(world, making(box_.fill_softness, state.friction));
    } else if (stage == kneaded && since(world) >= kneading) {
        load_plates(world, lift, {.times = {now, now + ramp}, .values = {force, 0}});
        go_on(lifting);
    } else if (stage == lifting && since(world) >= ramp) {
        state.porosity[lift] = porosity_of_lift(world, lift);
        state.surface[lift] = plates_height(world, lift);
        for (const CompactionPlate& plate : plates_of(world, lift)) {
            Vec3 away = value_of<Position>(world, plate.body);
            away.z() = 6 + 0.5 * static_cast<double>(lift == 0);
            park(world, plate.body, away);
        }
        return false;
    }
    return true;
}

Phase BoxTestRun::compact(std::size_t course) const {
    const std::size_t lift = lift_of(course);
    return {.advance =
                [this, lift](Simulation& s) {
                    s.advance(block);
                    scale_rocks(s.world(), s.world().resource<Clock>().dt);
                    return compact_further(s.world(), lift);
                },
            .progress =
                [lift](const World& world) {
                    const auto& state = world.resource<BoxState>();
                    return PhaseProgress{fmt::format("compact lift {}", lift + 1), -1,
                                         fmt::format("porosity {:.4f}, friction {:.2f}",
                                                     state.porosity[lift], state.friction)};
                },
            .begin =
                [this, lift](Simulation& s) {
                    if (is_made_fouled()) mix_fines(s);
                    begin_compaction(s.world(), lift);
                }};
}

Phase save_bed(const Run& run, const std::function<void()>& saved) {
    return {.advance =
                [&run, saved](Simulation&) {
                    run.save_as("bed");
                    if (saved) saved();
                    return false;
                },
            .progress =
                [](const World&) {
                    return PhaseProgress{"save the bed", 1, ""};
                }};
}

// overlaps that the soft contacts have under the weight of the ballast become forces; in small
// stages, with strong dashpots, the bed follows
Phase BoxTestRun::harden() const {
    const double stages = std::ceil(std::log(1 / box_.fill_softness) / std::log(stage_factor));
    const auto softness = [this, stages](double stage) {
        return stage >= stages ? 1.0 : box_.fill_softness * std::pow(stage_factor, stage);
    };
    return {
        .advance =
            [this, softness, stages](Simulation& s) {
                s.advance(stage_steps);
                auto& state = s.world().resource<BoxState>();
                if (state.stage >= stages + 3) { // some stages more to come to rest
                    s.world().resource<Limits>().overlap = Limits{}.overlap;
                    if (!box_.is_dynamic()) {
                        // scaled masses leave no room for dashpots that are stronger
                        set_materials(s.world());
                        const auto scaling = scale_masses(s.world(), 0, scaling_safety, false);
                        s.world().resource<Clock>().change_step(scaling.dt);
                        damp_subgrade(s.world(), scaling.total_mass);
                    }
                    return false;
                }
                ++state.stage;
                set_materials(s.world(), making(softness(state.stage)));
                adapt_step(s.world(), hard_step_ / std::sqrt(softness(state.stage)));
                return true;
            },
        .progress =
            [stages](const World& world) {
                return PhaseProgress{"harden", world.resource<BoxState>().stage / (stages + 3), ""};
            },
        .begin =
            [this](Simulation& s) {
                note_beginning(s.world());
                s.world().resource<BoxState>().stage = 0;
                take_true_masses(s.world());
            }};
}

} // namespace bris

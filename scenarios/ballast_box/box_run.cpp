#include "scenarios/ballast_box/box_run.hpp"

#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "scenarios/ballast_box/pour.hpp"
#include "scenarios/ballast_box/rail.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/mass_scaling.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/output/quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr std::uint64_t block = 200;           // steps
constexpr double first_contact_fraction = 0.7; // of the stable step of a first contact
constexpr double making_fraction = 0.7;        // of the stable step, while the bed is made
constexpr double making_restitution = 0.1;     // upper limit, so that rocks come to rest soon
constexpr double stage_factor = 1.25;          // of hardening
constexpr std::uint64_t stage_steps = 300;
constexpr double scaling_safety = 0.8; // of mass scaling
constexpr double seating_steps = 6000;

double since(const World& world) {
    return world.resource<Clock>().time() - world.resource<BoxState>().began;
}
void note_beginning(World& world) {
    world.resource<BoxState>().began = world.resource<Clock>().time();
}

/// Follows the stable step of the contacts, which must be known, up to `longest` (s).
void adapt_step(World& world, double longest) {
    Clock& clock = world.resource<Clock>();
    const double stable = stable_step(world), wanted = std::min(longest, making_fraction * stable);
    if (clock.dt > 1.2 * wanted || clock.dt < 0.7 * wanted) clock.change_step(wanted);
}

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

double kinetic_ratio(const World& world) {
    const Quantities q = compute_quantities(world);
    return q.kinetic_energy / (q.weight.norm() * mean_radius(world));
}

} // namespace

std::vector<std::vector<double>> tie_shares(const BallastBox& box) {
    constexpr double bay = 0.61;
    if (!box.is_dynamic()) return {{1.0, 0.0}};
    std::vector<double> at;
    for (unsigned k = 0; k < box.box_ties; ++k) at.push_back(bay * k);
    const std::size_t first = box.box_ties == 4 ? 1 : 0; // the model's ties are the middle ones
    std::vector<std::vector<double>> shares(2, std::vector<double>(2));
    for (std::size_t actuator = 0; actuator < 2; ++actuator) {
        const auto r = rail_reactions(at, box.tie_support, box.rail_bending, at[first + actuator]);
        for (std::size_t tie = 0; tie < 2; ++tie) shares[tie][actuator] = r[first + tie];
    }
    return shares;
}

BoxTestRun::BoxTestRun(Simulation& simulation, const BallastBox& box, std::uint64_t seed)
    : simulation_(simulation), box_(box), sizes_(box_sizes(box)), seed_(seed), hard_step_(0) {
    World& world = simulation_.world();
    hard_step_ = first_contact_fraction * stable_step_of_first_contact(world);
    if (world.resource<Clock>().dt == 0) {
        world.resource<Clock>().dt = hard_step_ / std::sqrt(box_.fill_softness);
        set_softness(world, box_.fill_softness, making_restitution);
    }
}

void BoxTestRun::set_load(World& world, EntityId body, const LoadHistory& history) const {
    const std::uint32_t number = value_of<LoadOf>(world, body);
    world.resource<Loads>().of_body[number - 1].front().history = history;
}

Phase BoxTestRun::pour(std::size_t course) const {
    constexpr double least = 0.25, longest = 0.8; // s
    return {.advance =
                [this](Simulation& s) {
                    s.advance(block);
                    adapt_step(s.world(), hard_step_ / std::sqrt(box_.fill_softness));
                    const double now = since(s.world());
                    return now < least || (now < longest && kinetic_ratio(s.world()) > 1e-2);
                },
            .progress =
                [course](const World& world) {
                    return PhaseProgress{fmt::format("pour course {}", course + 1),
                                         since(world) / longest, ""};
                },
            .begin =
                [this, course](Simulation& s) {
                    note_beginning(s.world());
                    if (course == 1) place_bladder(s.world(), sizes_);
                    pour_course(s.world(), sizes_, course, seed_);
                }};
}

Phase BoxTestRun::compact(std::size_t course) const {
    constexpr double ramp = 0.05, hold = 0.25, frequency = 30; // s, Hz
    return {
        .advance =
            [this](Simulation& s) {
                World& world = s.world();
                const EntityId plate = world.resource<BoxBodies>().plate;
                s.advance(block);
                adapt_step(world, hard_step_ / std::sqrt(box_.fill_softness));
                if (since(world) < 2 * ramp + hold) return true;
                world.resource<BoxState>().surface = value_of<Position>(world, plate).z() - 0.025;
                Vec3 away = value_of<Position>(world, plate);
                away.z() = 6;
                park(world, plate, away);
                return false;
            },
        .progress =
            [course](const World& world) {
                return PhaseProgress{fmt::format("compact course {}", course + 1),
                                     since(world) / (2 * ramp + hold), ""};
            },
        .begin =
            [this](Simulation& s) {
                World& world = s.world();
                note_beginning(world);
                const EntityId plate = world.resource<BoxBodies>().plate;
                Vec3 at = value_of<Position>(world, plate);
                at.z() = surface_height(world, Vec3::Zero(),
                                        Vec3(sizes_.width, sizes_.bladder_face(), 0), 0) +
                         0.026;
                release(world, plate, at);
                const double start = world.resource<Clock>().time(),
                             mean = box_.compaction_pressure * sizes_.width * sizes_.bladder_face();
                LoadHistory history{.mean = 0};
                const auto add = [&](double t, double value) {
                    history.times.push_back(start + t);
                    history.values.push_back(mean * value);
                };
                add(0, 0);
                constexpr int points = 16; // per period
                for (int k = 0; k <= static_cast<int>(hold * frequency * points); ++k)
                    add(ramp + k / (frequency * points), 1 + 0.6 * std::sin(2 * pi * k / points));
                add(2 * ramp + hold, 0);
                set_load(world, plate, history);
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
                    set_softness(s.world(), 1);
                    s.world().resource<Limits>().overlap = Limits{}.overlap;
                    if (!box_.is_dynamic()) {
                        const auto scaling = scale_masses(s.world(), 0, scaling_safety, false);
                        s.world().resource<Clock>().change_step(scaling.dt);
                        damp_subgrade(s.world(), scaling.total_mass);
                    }
                    return false;
                }
                ++state.stage;
                set_softness(s.world(), softness(state.stage), making_restitution);
                adapt_step(s.world(), hard_step_ / std::sqrt(softness(state.stage)));
                return true;
            },
        .progress =
            [stages](const World& world) {
                return PhaseProgress{"harden", world.resource<BoxState>().stage / (stages + 3), ""};
            },
        .begin =
            [](Simulation& s) {
                note_beginning(s.world());
                s.world().resource<BoxState>().stage = 0;
            }};
}

std::array<double, 2> BoxTestRun::tie_load(std::size_t tie) const {
    const auto shares = tie_shares(box_);
    const double mean = 0.5 * (box_.peak() + box_.least()),
                 amplitude = 0.5 * (box_.peak() - box_.least());
    if (!box_.is_dynamic()) return {sizes_.share * mean, -sizes_.share * amplitude};
    // the first actuator begins at its least load, the second one at its peak
    return {sizes_.share * mean * (shares[tie][0] + shares[tie][1]),
            sizes_.share * amplitude * (shares[tie][1] - shares[tie][0])};
}

void BoxTestRun::scale_tie(World& world, EntityId tie) const {
    constexpr double contacts = 50; // more than a tie has at first; then the masses are raised
    const double factor = std::pow(world.resource<Clock>().dt / scaling_safety, 2);
    double stiffness = 0, turning = 0;
    for (const SpringPatch& p :
         world.resource<SpringPatches>().of_body[value_of<PatchesOf>(world, tie) - 1]) {
        stiffness += p.stiffness;
        turning += p.stiffness * p.point.cross(p.axis).squaredNorm();
    }
    const double kn = contacts * world.resource<BoxBodies>().hard[0].normal_stiffness;
    const double mass = std::max(value_of<Mass>(world, tie), factor * (stiffness + kn));
    const Vec3& inertia = value_of<Inertia>(world, tie);
    const double ratio =
        std::max(mass / value_of<Mass>(world, tie),
                 factor * (turning + kn * sizes_.tie.squaredNorm() / 4) / inertia.minCoeff());
    value_of<InertialMass>(world, tie) = mass;
    value_of<InertialInertia>(world, tie) = ratio * inertia;
}

// the ties are laid on the ballast and loaded as at the beginning of the cycles
Phase BoxTestRun::seat() const {
    return {
        .advance =
            [this](Simulation& s) {
                World& world = s.world();
                s.advance(block);
                if (!box_.is_dynamic())
                    (void)scale_masses(world, world.resource<Clock>().dt, scaling_safety, true);
                if (++world.resource<BoxState>().stage * static_cast<double>(block) < seating_steps)
                    return true;
                if (box_.is_dynamic())
                    world.resource<Clock>().change_step(box_.step_fraction * stable_step(world));
                return false;
            },
        .progress =
            [](const World& world) {
                return PhaseProgress{"seat the ties",
                                     world.resource<BoxState>().stage * static_cast<double>(block) /
                                         seating_steps,
                                     ""};
            },
        .begin =
            [this](Simulation& s) {
                World& world = s.world();
                note_beginning(world);
                world.resource<BoxState>().stage = 0;
                const auto& ties = world.resource<BoxBodies>().ties;
                for (std::size_t k = 0; k < ties.size(); ++k) {
                    const Vec3 half = 0.5 * sizes_.tie;
                    const double x = sizes_.ties[k];
                    const double surface = surface_height(world, Vec3(x - half.x(), 0, 0),
                                                          Vec3(x + half.x(), sizes_.tie.y(), 0), 0);
                    const double level = box_.tie_level > 0 ? box_.tie_level : surface + 1e-5;
                    check_tie(world, sizes_, x, level, surface);
                    Vec3 at = value_of<Position>(world, ties[k]);
                    at.z() = level + half.z();
                    release(world, ties[k], at);
                    if (!box_.is_dynamic()) scale_tie(world, ties[k]);
                }
                const double start = world.resource<Clock>().time(),
                             ramp = 0.5 * seating_steps * world.resource<Clock>().dt;
                for (std::size_t k = 0; k < ties.size(); ++k) {
                    const auto [mean, amplitude] = tie_load(k);
                    set_load(world, ties[k],
                             {.times = {start, start + ramp}, .values = {0, mean + amplitude}});
                }
            }};
}

// the bladder is drawn back to the wall and no longer supports the ballast
Phase BoxTestRun::remove_shoulder() const {
    constexpr double drawing_steps = 8000, resting_steps = 4000;
    return {
        .advance =
            [this](Simulation& s) {
                World& world = s.world();
                auto& state = world.resource<BoxState>();
                const EntityId bladder = world.resource<BoxBodies>().bladder;
                s.advance(block);
                const double done = ++state.stage * static_cast<double>(block);
                if (done >= drawing_steps && value_of<DriveVelocity>(world, bladder).norm() > 0) {
                    value_of<DriveVelocity>(world, bladder).setZero();
                    invalidate_lists(world);
                }
                if (done < drawing_steps + resting_steps) return true;
                if (!box_.is_dynamic())
                    (void)scale_masses(world, world.resource<Clock>().dt, scaling_safety, true);
                return false;
            },
        .progress =
            [](const World& world) {
                return PhaseProgress{"remove the shoulder",
                                     world.resource<BoxState>().stage * static_cast<double>(block) /
                                         (drawing_steps + resting_steps),
                                     ""};
            },
        .begin =
            [this](Simulation& s) {
                World& world = s.world();
                note_beginning(world);
                world.resource<BoxState>().stage = 0;
                const EntityId bladder = world.resource<BoxBodies>().bladder;
                value_of<MotionOf>(world, bladder) = static_cast<std::uint32_t>(Motion::prescribed);
                value_of<DriveVelocity>(world, bladder) =
                    Vec3(0, sizes_.bladder_depth / (drawing_steps * world.resource<Clock>().dt), 0);
                invalidate_lists(world);
            }};
}

std::vector<Phase> BoxTestRun::preparation() {
    std::vector<Phase> phases;
    for (std::size_t course = 0; course < courses.size(); ++course) {
        phases.push_back(pour(course));
        if (courses[course].compacted) phases.push_back(compact(course));
    }
    phases.push_back(harden());
    phases.push_back(seat());
    if (!box_test(box_.run).confined) phases.push_back(remove_shoulder());
    return phases;
}

std::uint64_t BoxTestRun::steps_per_cycle() const {
    if (!box_.is_dynamic()) return box_.steps_per_cycle;
    const double dt = std::as_const(simulation_).world().resource<Clock>().dt;
    return static_cast<std::uint64_t>(std::llround(1 / (box_.load_frequency() * dt)));
}

void BoxTestRun::begin_loading(Simulation& simulation) const {
    World& world = simulation.world();
    note_beginning(world);
    const Clock& clock = world.resource<Clock>();
    const double frequency = 1 / (static_cast<double>(steps_per_cycle()) * clock.dt);
    const auto& ties = world.resource<BoxBodies>().ties;
    auto& state = world.resource<BoxState>();
    state.tie_1 = value_of<Position>(world, ties.front()).z();
    state.tie_2 = value_of<Position>(world, ties.back()).z();
    state.bladder = value_of<Position>(world, world.resource<BoxBodies>().bladder).y();
    for (std::size_t k = 0; k < ties.size(); ++k) {
        const auto [mean, amplitude] = tie_load(k);
        // mean + amplitude cos(2 pi f t)
        set_load(world, ties[k],
                 {.mean = mean,
                  .amplitude = amplitude,
                  .frequency = frequency,
                  .phase = 0.5 * pi,
                  .start = clock.time()});
    }
    if (box_.is_dynamic()) start_recording(world);
}

void BoxTestRun::add_sample(const World& world, Series& cycles) const {
    const auto& bodies = world.resource<BoxBodies>();
    const double now = since(world);
    const auto& loads = world.resource<Loads>().of_body;
    const auto position = [&](EntityId body) -> const Vec3& {
        return world.column<Bodies, Position>()[row_of_body(world, body)];
    };
    const auto load = [&](std::size_t k) {
        const auto number = world.column<Bodies, LoadOf>()[row_of_body(world, bodies.ties[k])];
        return loads[number - 1].front().history.at(world.resource<Clock>().time());
    };
    const std::size_t second = bodies.ties.size() - 1;
    const Row bladder = row_of_body(world, bodies.bladder);
    // what acts on the bladder besides pressure and springs is the ballast
    const double on_bladder = world.column<Bodies, Force>()[bladder].y() -
                              world.column<Bodies, LoadForce>()[bladder].force.y() -
                              world.column<Bodies, PatchForce>()[bladder].force.y();
    double subgrade = 0;
    for (const EntityId plate : bodies.subgrade) subgrade = std::min(subgrade, position(plate).z());
    const auto& state = world.resource<BoxState>();
    cycles.add({now / (static_cast<double>(steps_per_cycle()) * world.resource<Clock>().dt), now,
                load(0), load(second), state.tie_1 - position(bodies.ties[0]).z(),
                state.tie_2 - position(bodies.ties[second]).z(),
                on_bladder / (sizes_.width * sizes_.bladder_height),
                position(bodies.bladder).y() - state.bladder, -subgrade - 0.025,
                compute_quantities(world).unbalanced_ratio});
}

Phase BoxTestRun::loading(const Run& run, Series& cycles, const std::function<void()>& frame) {
    constexpr std::uint64_t samples = 50; // per cycle
    return {.advance =
                [this, &run, &cycles, frame](Simulation& s) {
                    const std::uint64_t per_cycle = steps_per_cycle(), total = loading_steps();
                    const std::uint64_t done = run.steps_in_phase();
                    // equal parts of a cycle that end with it
                    const std::uint64_t k = done * samples / per_cycle + 1,
                                        next = (k * per_cycle + samples - 1) / samples;
                    s.advance(std::max<std::uint64_t>(next, done + 1) - done);
                    (void)checked_stable_step(s.world());
                    add_sample(s.world(), cycles);
                    const std::uint64_t now = run.steps_in_phase();
                    if (now % per_cycle == 0) {
                        frame();
                        if (!box_.is_dynamic())
                            (void)scale_masses(s.world(), s.world().resource<Clock>().dt,
                                               scaling_safety, true);
                    }
                    return now < total;
                },
            .progress =
                [this, &run](const World&) {
                    const auto done = static_cast<double>(run.steps_in_phase()),
                               per_cycle = static_cast<double>(steps_per_cycle());
                    return PhaseProgress{"load", done / static_cast<double>(loading_steps()),
                                         fmt::format("cycle {:.2f}", done / per_cycle)};
                },
            .begin = [this](Simulation& s) { begin_loading(s); }};
}

} // namespace bris

#include "scenarios/ballast_box/box_run.hpp"

#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "scenarios/ballast_box/box_balance.hpp"
#include "scenarios/ballast_box/rail.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/contact/mass_scaling.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/output/quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double first_contact_fraction = 0.7; // of the stable step of a first contact

} // namespace

double since(const World& world) {
    return world.resource<Clock>().time() - world.resource<BoxState>().began;
}
void note_beginning(World& world) {
    world.resource<BoxState>().began = world.resource<Clock>().time();
}

void adapt_step(World& world, double longest) {
    Clock& clock = world.resource<Clock>();
    const double stable = stable_step(world), wanted = std::min(longest, making_fraction * stable);
    if (clock.dt > 1.2 * wanted || clock.dt < 0.7 * wanted) clock.change_step(wanted);
}

void raise_masses(World& world) {
    (void)scale_masses(world, world.resource<Clock>().dt, scaling_safety, true);
}

MakingMaterials making(double softness, double friction) {
    return {.softness = softness, .most_restitution = making_restitution, .friction = friction};
}

std::vector<std::vector<double>> tie_shares(const BallastBox& box) {
    constexpr double bay = tie_spacing;
    if (!box.is_dynamic()) return {{1.0, 0.0}};
    std::vector<double> at;
    for (unsigned k = 0; k < box.ties(); ++k) at.push_back(bay * k);
    const BoxSizes sizes = box_sizes(box);
    const std::size_t ties = sizes.ties.size(),
                      first = (at.size() - ties) / 2; // the model's ties are the middle ones
    const TrackRail rail(at, std::vector<TieSupport>(at.size(), {.stiffness = box.tie_support}),
                         box.rail_bending, 0);
    std::vector<std::vector<double>> shares(ties, std::vector<double>(2));
    for (std::size_t actuator = 0; actuator < 2; ++actuator) {
        const double load = at[first + sizes.loaded[actuator]];
        for (std::size_t tie = 0; tie < ties; ++tie)
            shares[tie][actuator] = rail.influence_on(first + tie)(load);
    }
    return shares;
}

BoxTestRun::BoxTestRun(Simulation& simulation, const BallastBox& box, std::uint64_t seed)
    : simulation_(simulation), box_(box), sizes_(box_sizes(box)), seed_(seed), hard_step_(0) {
    World& world = simulation_.world();
    hard_step_ = first_contact_fraction * stable_step_of_first_contact(world);
    if (box_.restitution > 0)
        for (Material& m : world.resource<BoxBodies>().hard) m.restitution = box_.restitution;
    if (world.resource<Clock>().dt == 0) {
        world.resource<Clock>().dt = hard_step_ / std::sqrt(box_.fill_softness);
        set_materials(world, making(box_.fill_softness));
        remove_later_courses(world);
    }
}

void BoxTestRun::set_load(World& world, EntityId body, const LoadHistory& history) const {
    const std::uint32_t number = value_of<LoadOf>(world, body);
    world.resource<Loads>().of_body[number - 1].front().history = history;
}

std::array<double, 2> BoxTestRun::tie_load(std::size_t tie) const {
    if (box_.is_bay()) return {sizes_.share * dead_load, 0};
    const auto shares = tie_shares(box_);
    const double mean = 0.5 * (box_.peak() + box_.least()),
                 amplitude = 0.5 * (box_.peak() - box_.least());
    if (!box_.is_dynamic()) return {sizes_.share * mean, -sizes_.share * amplitude};
    // the first actuator begins at its least load, the second one at its peak
    return {sizes_.share * mean * (shares[tie][0] + shares[tie][1]),
            sizes_.share * amplitude * (shares[tie][1] - shares[tie][0])};
}

std::vector<Phase> BoxTestRun::making_of_bed() const {
    std::vector<Phase> phases;
    for (std::size_t course = 0; course < courses.size(); ++course) {
        phases.push_back(pour(course));
        if (courses[course].compacted) phases.push_back(compact(course));
    }
    phases.push_back(harden());
    return phases;
}

std::vector<Phase> BoxTestRun::seating() const {
    std::vector<Phase> phases;
    if (is_fouled()) phases.push_back(foul_bed());
    phases.push_back(seat());
    if (!box_test(box_.run).confined) phases.push_back(remove_shoulder());
    return phases;
}

std::vector<Phase> BoxTestRun::bed_of_track() const {
    std::vector<Phase> phases = making_of_bed();
    if (is_made_fouled()) phases.push_back(foul_bed());
    phases.push_back(seat());
    return phases;
}

std::vector<Phase> BoxTestRun::changes_in_use() const {
    std::vector<Phase> phases;
    if (!is_made_fouled() && (is_fouled() || is_wet())) phases.push_back(foul_track());
    if (!box_test(box_.run).confined) phases.push_back(remove_shoulder());
    return phases;
}

std::vector<Phase> BoxTestRun::preparation(std::optional<Phase> save) const {
    std::vector<Phase> phases = making_of_bed();
    if (save) phases.push_back(*std::move(save));
    for (Phase& phase : seating()) phases.push_back(std::move(phase));
    return phases;
}

std::uint64_t BoxTestRun::loading_steps() const {
    constexpr std::uint64_t some_steps = 200; // of the model `full`
    const unsigned cycles = box_.load_cycles();
    return cycles > 0 ? steps_per_cycle() * cycles : some_steps;
}

std::uint64_t BoxTestRun::steps_per_cycle() const {
    if (!box_.is_dynamic()) return box_.steps_per_cycle;
    const double dt = std::as_const(simulation_).world().resource<Clock>().dt;
    return static_cast<std::uint64_t>(std::llround(1 / (box_.load_frequency() * dt)));
}

void BoxTestRun::begin_real_time(World& world) const {
    set_materials(world, {.friction = friction_of_stones(world)});
    if (box_.is_dynamic())
        world.resource<Clock>().change_step(box_.step_fraction * stable_step(world));
    note_beginning(world);
    if (box_.is_dynamic()) start_recording(world);
}

void BoxTestRun::note_bed(World& world) const {
    const auto& ties = world.resource<BoxBodies>().ties;
    auto& state = world.resource<BoxState>();
    state.bed_porosity = porosity_between(world, 0, state.surface.back());
    state.tie_1 = value_of<Position>(world, ties[sizes_.loaded[0]]).z();
    state.tie_2 = value_of<Position>(world, ties[sizes_.loaded[1]]).z();
    state.bladder = value_of<Position>(world, world.resource<BoxBodies>().bladder).y();
}

void BoxTestRun::begin_passage(World& world, LoadHistory load) const {
    begin_real_time(world);
    const double now = world.resource<Clock>().time();
    for (double& time : load.times) time += now;
    for (double& value : load.values) value *= sizes_.share;
    set_load(world, world.resource<BoxBodies>().ties.front(), load);
}

void BoxTestRun::begin_loading(Simulation& simulation) const {
    World& world = simulation.world();
    begin_real_time(world);
    note_bed(world);
    const Clock& clock = world.resource<Clock>();
    const double frequency = 1 / (static_cast<double>(steps_per_cycle()) * clock.dt);
    const auto& ties = world.resource<BoxBodies>().ties;
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
}

void BoxTestRun::add_sample(const World& world, SeriesOf<CycleSample>& cycles) const {
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
    const auto [first, second] = sizes_.loaded;
    const double on_bladder = contact_force(world, bodies.bladder).y();
    double subgrade = 0, subgrade_energy = 0;
    for (const EntityId plate : bodies.subgrade) {
        subgrade = std::min(subgrade, position(plate).z());
        subgrade_energy += patch_energy(world, row_of_body(world, plate));
    }
    const Quantities q = compute_quantities(world);
    const auto& state = world.resource<BoxState>();
    const BoxBalance balance = box_balance(world);
    const double period = static_cast<double>(steps_per_cycle()) * world.resource<Clock>().dt;
    cycles.add({.cycle = now / period,
                .time = now,
                .load_1 = load(first),
                .load_2 = load(second),
                .deflection_1 = state.tie_1 - position(bodies.ties[first]).z(),
                .deflection_2 = state.tie_2 - position(bodies.ties[second]).z(),
                .bladder_pressure = on_bladder / (sizes_.width * sizes_.bladder_height),
                .bladder_displacement = position(bodies.bladder).y() - state.bladder,
                .subgrade_settlement = -subgrade - 0.025,
                .tie_load = balance.tie_load,
                .tie_support = balance.tie_support,
                .subgrade_force = balance.subgrade_force,
                .unbalanced_ratio = balance.unbalanced_ratio,
                .subgrade_energy = subgrade_energy,
                .contact_energy = q.elastic_energy - q.element_energy});
}

Phase BoxTestRun::loading(const Run& run, SeriesOf<CycleSample>& cycles,
                          const std::function<void()>& frame) {
    constexpr std::uint64_t samples = 50; // per cycle
    return {.advance =
                [this, &run, &cycles, frame](Simulation& s) {
                    const std::uint64_t per_cycle = steps_per_cycle(), total = loading_steps();
                    const std::uint64_t done = run.steps_in_phase();
                    // equal parts of a cycle that end with it
                    const std::uint64_t k = done * samples / per_cycle + 1,
                                        next = (k * per_cycle + samples - 1) / samples;
                    s.advance(std::min(std::max<std::uint64_t>(next, done + 1), total) - done);
                    check_stable_step(s.world());
                    add_sample(s.world(), cycles);
                    const std::uint64_t now = run.steps_in_phase();
                    if (now % per_cycle == 0 && !box_.is_dynamic()) raise_masses(s.world());
                    if (now % per_cycle == 0 || now == total) frame();
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

#include "scenarios/ballast_box/passages.hpp"

#include "components/kinds.hpp"
#include "engine/errors.hpp"
#include "scenarios/ballast_box/box_balance.hpp"
#include "scenarios/ballast_box/shells.hpp"
#include "scenarios/ballast_box/tie_under_rails.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/loads/load.hpp"
#include "systems/loads/spring_patch.hpp"
#include "systems/output/quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double sample_interval = 5e-3; // s
constexpr std::uint64_t samples_per_frame = 20;

std::uint64_t steps_per_sample(const World& world) {
    const double dt = world.resource<Clock>().dt;
    return std::max<std::uint64_t>(1,
                                   static_cast<std::uint64_t>(std::llround(sample_interval / dt)));
}

void add_sample(const World& world, unsigned number, SeriesOf<PassageSample>& samples) {
    const EntityId tie = world.resource<BoxBodies>().ties.front();
    const Row row = row_of_body(world, tie);
    const auto load = world.column<Bodies, LoadOf>()[row] - 1;
    const LoadHistory& history = world.resource<Loads>().of_body[load].front().history;
    const BoxBalance balance = box_balance(world);
    const double of_spring = world.column<Bodies, PatchForce>()[row].force.z();
    const double height = world.column<Bodies, Position>()[row].z();
    samples.add({.passage = static_cast<double>(number),
                 .time = since(world),
                 .load = history.at(world.resource<Clock>().time()) - of_spring,
                 .deflection = world.resource<BoxState>().tie_1 - height,
                 .tie_support = balance.tie_support,
                 .subgrade_force = balance.subgrade_force,
                 .unbalanced_ratio = balance.unbalanced_ratio});
}

/// Where what happens in a passage goes.
struct Records {
    SeriesOf<PassageSample>* samples = nullptr;
    const PassageActions* actions = nullptr;
};

/// A train that passes; number 0: the first train, of which nothing is recorded.
Phase pass(const BoxTestRun& test, const TrackPassage& settings, const Train& train, double speed,
           unsigned number, Records to, const Run& run) {
    const auto duration_in = [=](const World& world) {
        return passing_time(train, speed, settings.rails(world));
    };
    const bool hangs = settings.gap > 0 && number > 0;
    return {.advance =
                [=, &test, &run](Simulation& s) {
                    World& world = s.world();
                    const double duration = duration_in(world);
                    const std::uint64_t steps = steps_per_sample(world);
                    if (since(world) < duration) {
                        s.advance(steps);
                        check_stable_step(world);
                        const double last_axle =
                            duration - settings.rails(world).reach() / speed; // is above the tie
                        if (world.resource<BoxState>().pressed_support == 0 &&
                            since(world) >= last_axle)
                            note_pressed_tie(world);
                        if (number > 0) add_sample(world, number, *to.samples);
                        if (number > 0 && run.steps_in_phase() / steps % samples_per_frame == 0)
                            to.actions->frame();
                        if (since(world) < duration) return true;
                    }
                    if (!hangs) note_bed_stiffness(world, test.sizes().share);
                    if (number > 0) to.actions->completed(number);
                    return false;
                },
            .progress =
                [=](const World& world) {
                    const std::string name =
                        number > 0 ? fmt::format("passage {}", number) : "first train";
                    const double duration = duration_in(world);
                    return PhaseProgress{name, since(world) / duration,
                                         fmt::format("{:.2f} of {:.2f} s", since(world), duration)};
                },
            .begin =
                [=, &test](Simulation& s) {
                    World& world = s.world();
                    if (number > 0) change_shells(world, settings.box);
                    const RailOnTies rails = settings.rails(world);
                    world.resource<BoxState>().pressed_support = 0;
                    test.begin_passage(world, hangs ? passing_load_of_hanging_tie(
                                                          train, speed, rails, dead_load,
                                                          mass_of_tie(world) / test.sizes().share,
                                                          -world.resource<Gravity>().value.z())
                                                    : passing_load(train, speed, rails, dead_load));
                }};
}

/// The tie is hung up, and the ballast comes to rest without its weight.
Phase hang_up(const BoxTestRun& test, const TrackPassage& settings) {
    constexpr double duration = 0.1; // s
    return {.advance =
                [](Simulation& s) {
                    s.advance(block);
                    return since(s.world()) < duration;
                },
            .progress =
                [](const World& world) {
                    return PhaseProgress{"hang the tie up", since(world) / duration, ""};
                },
            .begin =
                [&test, settings](Simulation& s) {
                    note_beginning(s.world());
                    hang_tie(s.world(), settings.rails(s.world()), test.sizes().share,
                             settings.gap);
                    s.prepare();
                }};
}

/// A step, after which the contacts of a bed that was read from a file are known: the time step of
/// a passage follows from them.
Phase find_contacts() {
    return {.advance =
                [](Simulation& s) {
                    s.advance(1);
                    return false;
                },
            .progress =
                [](const World&) {
                    return PhaseProgress{"find the contacts", 0, ""};
                }};
}

} // namespace

RailOnTies rails_on(const BallastBox& box, double pads, double bed) {
    return {.bending = box.rail_bending,
            .tie_support = box.tie_support > 0 ? box.tie_support : in_series(pads, bed),
            .spacing = tie_spacing,
            .tie_weight = weight_of_tie,
            .pad = pads};
}

RailOnTies TrackPassage::rails(const World& world) const {
    const double measured = world.resource<BoxState>().bed_stiffness;
    return rails_on(box, pad_stiffness, measured > 0 ? measured : usual_bed);
}

Phase first_passage(const BoxTestRun& test, const Run& run, const TrackPassage& settings) {
    return pass(test, settings, train_named(settings.first_train, "--first-train"),
                settings.speed_of(settings.first_train), 0, {}, run);
}

std::vector<Phase> passage_phases(const BoxTestRun& test, const Run& run,
                                  const TrackPassage& settings, const Train& train,
                                  SeriesOf<PassageSample>& samples, const PassageActions& actions) {
    std::vector<Phase> phases;
    if (settings.first_train != "none") phases.push_back(first_passage(test, run, settings));
    Phase save = save_bed(run, actions.bed_saved);
    save.begin = [&test](Simulation& s) { test.note_bed(s.world()); };
    phases.push_back(std::move(save));
    for (Phase& phase : test.changes_in_use()) phases.push_back(std::move(phase));
    if (settings.gap > 0) phases.push_back(hang_up(test, settings));
    phases.push_back(find_contacts());
    for (unsigned number = 1; number <= settings.passages; ++number)
        phases.push_back(
            pass(test, settings, train, settings.train_speed(), number, {&samples, &actions}, run));
    return phases;
}

PassageResponse passage_response(const SeriesOf<PassageSample>& samples, unsigned number) {
    const auto& passage = samples[&PassageSample::passage];
    const auto [first, last] =
        std::equal_range(passage.begin(), passage.end(), static_cast<double>(number));
    require(first != last, fmt::format("samples: expected passage {}, found none", number));
    const auto from = static_cast<std::size_t>(first - passage.begin()),
               to = static_cast<std::size_t>(last - passage.begin());
    const auto &load = samples[&PassageSample::load],
               &deflection = samples[&PassageSample::deflection],
               &support = samples[&PassageSample::tie_support];
    PassageResponse r{.settlement = deflection[to - 1] - deflection[from]};
    for (std::size_t k = from; k < to; ++k) {
        r.deflection = std::max(r.deflection, deflection[k] - deflection[from]);
        r.largest_load = std::max(r.largest_load, load[k]);
        r.largest_support = std::max(r.largest_support, support[k]);
    }
    return r;
}

} // namespace bris

#include "engine/simulation.hpp"

#include "engine/clock.hpp"
#include "engine/errors.hpp"
#include "engine/health.hpp"
#include "engine/state.hpp"
#include "engine/stopwatch.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace bris {

Simulation::Simulation(World world, StepList steps, unsigned threads, ScheduleSettings settings)
    : world_(std::make_unique<World>(std::move(world))), steps_(steps), settings_(settings),
      threads_(std::make_unique<Threads>(threads)), alone_(std::make_unique<Threads>(1)),
      schedule_(std::move(steps), settings) {
    prepare();
}

/// After an error of the steps the whole world is up to date: of all ranks, unlike other errors.
template <class Steps>
void Simulation::stop_all_alike(Steps&& steps) {
    try {
        steps();
    } catch (const SimulationError&) {
        owed_ = 0;
        look();
        throw;
    }
}

void Simulation::advance_unseen(std::uint64_t steps) {
    if (division_.take == nullptr) return run(*world_, schedule_, steps, true);
    owed_ += steps;
    stop_all_alike([&] { advance_owed(); });
}

void Simulation::advance_owed() {
    // taking a part and giving it back costs as much as some tens of steps
    constexpr std::uint64_t fewest = 20;
    while (owed_ > 1) { // the last one is for `look` or `observe`
        if (part_ != nullptr || (owed_ > fewest && !division_.whole_step_is_due(*world_))) {
            advance_part();
        } else {
            run(*world_, schedule_, 1, false);
            --owed_;
        }
    }
    if (part_ == nullptr) run(*world_, schedule_, std::exchange(owed_, 0), true);
}

/// Computes all but the last of the steps on the part, or those before one that needs the whole
/// world.
void Simulation::advance_part() {
    if (part_ == nullptr) take_part();
    const Clock& clock = part_->world.resource<Clock>();
    const std::uint64_t before = clock.step;
    run(part_->world, part_->schedule, owed_ - 1, false, division_.whole_step_is_due);
    owed_ -= clock.step - before;
    if (owed_ > 1) give_back();
}

void Simulation::take_part() {
    ScheduleSettings settings = settings_;
    settings.overlap = false; // messages are sent by the thread that runs main
    part_ = std::make_unique<Part>(division_.take(*world_), steps_, settings);
    has_records_ = count_.steps == 0; // before the first step there are none to lose
}

World& Simulation::divide_now() {
    if (division_.take != nullptr && part_ == nullptr) take_part();
    return part_ != nullptr ? part_->world : *world_;
}

void Simulation::give_back() {
    division_.give_back(part_->world, *world_);
    for (const auto& [name, seconds] : part_->schedule.seconds())
        seconds_of_parts_[name] += seconds;
    part_.reset();
    has_records_ = false;
}

std::map<std::string, double> Simulation::seconds() const {
    auto all = schedule_.seconds();
    for (const auto& [name, seconds] : seconds_of_parts_) all[name] += seconds;
    return all;
}

void Simulation::look() {
    if (part_ == nullptr) return;
    give_back();
    run(*world_, schedule_, std::exchange(owed_, 0), true);
}

void Simulation::observe() {
    if (part_ == nullptr || owed_ == 0) return;
    if (!division_.can_be_observed(part_->world) || division_.whole_step_is_due(part_->world))
        return look();
    stop_all_alike([&] { run(part_->world, part_->schedule, std::exchange(owed_, 0), true); });
}

const World& Simulation::observed() const {
    if (!is_observed()) throw std::logic_error("contacts of a simulation before it was observed");
    return part_ != nullptr ? part_->world : *world_;
}

std::uint64_t Simulation::step() const {
    return (part_ ? part_->world : *world_).resource<Clock>().step + owed_;
}

void Simulation::run(World& world, Schedule& schedule, std::uint64_t steps, bool observed,
                     bool (*until)(const World&)) {
    Clock& clock = world.resource<Clock>();
    const Health& health = world.resource<Health>();
    const auto began = this_instant();
    const std::uint64_t before = clock.step;
    (world.rows() < settings_.least_rows ? alone_ : threads_)->run([&] {
        for (std::uint64_t k = 0; k < steps && !health.bad; ++k) {
            if (until != nullptr && until(world)) break;
            clock.last = k + 1 == steps;
            clock.observed = observed && clock.last;
            schedule.run(world);
            ++clock.step;
        }
    });
    if (clock.step > before) has_records_ = clock.observed;
    count_.steps += clock.step - before;
    count_.wall_time += seconds_since(began);
    if (health.bad)
        throw SimulationError(
            fmt::format("step {}, time {:.6g} s: {}", clock.step, clock.time(), health.what));
}

StateOfWorld Simulation::state() const {
    if (owed_ > 0) throw std::logic_error("State of a simulation before its last step");
    return part_ != nullptr ? StateOfWorld(part_->world, *world_, division_.rows_to_save)
                            : StateOfWorld(*world_);
}

Archive Simulation::snapshot() const {
    if (part_ != nullptr)
        throw std::logic_error("snapshot of a simulation before it was looked at");
    return save_state(*world_);
}

void Simulation::restore(const Archive& state) {
    part_.reset();
    owed_ = 0;
    load_state(*world_, state);
    world_->resource<Health>() = {};
    if (on_restore_ != nullptr) on_restore_(*world_);
    prepare();
}

} // namespace bris

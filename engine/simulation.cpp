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

void Simulation::advance_unseen(std::uint64_t steps) {
    // taking a part and giving it back costs as much as some tens of steps
    constexpr std::uint64_t fewest = 20;
    if (division_.take == nullptr || (part_ == nullptr && steps < fewest))
        return run(*world_, schedule_, steps, true);
    if (part_ == nullptr) {
        ScheduleSettings settings = settings_;
        settings.serial = true; // messages are sent by the thread that runs main
        part_ = std::make_unique<Part>(division_.take(*world_), steps_, settings);
    }
    const std::uint64_t now = owed_ + steps - 1; // the last one is for `look`
    owed_ = 1;
    if (now == 0) return;
    try {
        run(part_->world, part_->schedule, now, false);
    } catch (...) {
        owed_ = 0;
        look();
        throw;
    }
}

void Simulation::look() {
    if (part_ == nullptr) return;
    division_.give_back(part_->world, *world_);
    part_.reset();
    run(*world_, schedule_, std::exchange(owed_, 0), true);
}

std::uint64_t Simulation::step() const {
    return (part_ ? part_->world : *world_).resource<Clock>().step + owed_;
}

void Simulation::run(World& world, Schedule& schedule, std::uint64_t steps, bool observed) {
    Clock& clock = world.resource<Clock>();
    const Health& health = world.resource<Health>();
    const auto began = this_instant();
    const std::uint64_t before = clock.step;
    (world.rows() < settings_.least_rows ? alone_ : threads_)->run([&] {
        for (std::uint64_t k = 0; k < steps && !health.bad; ++k) {
            clock.observed = observed && k + 1 == steps;
            schedule.run(world);
            ++clock.step;
        }
    });
    count_.steps += clock.step - before;
    count_.wall_time += seconds_since(began);
    if (health.bad)
        throw SimulationError(
            fmt::format("step {}, time {:.6g} s: {}", clock.step, clock.time(), health.what));
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

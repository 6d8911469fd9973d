#include "engine/simulation.hpp"

#include "engine/clock.hpp"
#include "engine/errors.hpp"
#include "engine/health.hpp"
#include "engine/state.hpp"
#include "engine/stopwatch.hpp"

#include <fmt/format.h>

namespace bris {

Simulation::Simulation(World world, StepList steps, unsigned threads, ScheduleSettings settings)
    : world_(std::make_unique<World>(std::move(world))),
      threads_(std::make_unique<Threads>(threads)), alone_(std::make_unique<Threads>(1)),
      least_rows_(settings.least_rows), schedule_(std::move(steps), settings) {
    prepare();
}

void Simulation::advance(std::uint64_t steps) {
    Clock& clock = world_->resource<Clock>();
    const Health& health = world_->resource<Health>();
    const auto began = this_instant();
    const std::uint64_t before = clock.step;
    (world_->rows() < least_rows_ ? alone_ : threads_)->run([&] {
        for (std::uint64_t k = 0; k < steps && !health.bad; ++k) {
            clock.observed = k + 1 == steps;
            schedule_.run(*world_);
            ++clock.step;
        }
    });
    count_.steps += clock.step - before;
    count_.wall_time += seconds_since(began);
    if (health.bad)
        throw SimulationError(
            fmt::format("step {}, time {:.6g} s: {}", clock.step, clock.time(), health.what));
}

Archive Simulation::snapshot() const { return save_state(*world_); }

void Simulation::restore(const Archive& state) {
    load_state(*world_, state);
    world_->resource<Health>() = {};
    if (on_restore_ != nullptr) on_restore_(*world_);
    prepare();
}

} // namespace bris

#pragma once

#include "engine/parallel.hpp"
#include "engine/schedule.hpp"
#include "engine/world.hpp"

#include <filesystem>

namespace bris {

/// Steps that a simulation has run in this process.
struct StepCount {
    std::uint64_t steps = 0;
    double wall_time = 0; ///< s, within `advance`
};

/// A world with its schedule and threads. The world must hold a Clock and a Health.
class Simulation {
public:
    Simulation(World world, StepList steps, unsigned threads = 1, ScheduleSettings settings = {});

    World& world() { return *world_; }
    const World& world() const { return *world_; }
    Schedule& schedule() { return schedule_; }

    /// Runs `steps` steps, on one thread if the world is too small for several. Throws
    /// SimulationError (step, time, reason) if a guard reports a problem.
    void advance(std::uint64_t steps = 1);
    const StepCount& count() const { return count_; }
    /// Binds the schedule again after tables, columns or resources were added.
    void prepare() { schedule_.prepare(*world_); }

    /// A copy of all State in memory; `restore` puts it back to the same bits.
    Archive snapshot() const;
    void restore(const Archive& state);

    /// Registers a function that `restore` calls after the State was loaded, to rebuild derived
    /// data.
    void on_restore(void (*function)(World&)) { on_restore_ = function; }

private:
    std::unique_ptr<World> world_; // at a fixed address: bound systems point into it
    std::unique_ptr<Threads> threads_, alone_;
    std::size_t least_rows_;
    Schedule schedule_;
    void (*on_restore_)(World&) = nullptr;
    StepCount count_;
};

} // namespace bris

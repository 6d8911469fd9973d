#pragma once

#include "engine/parallel.hpp"
#include "engine/schedule.hpp"
#include "engine/state_of_world.hpp"
#include "engine/world.hpp"

#include <map>
#include <memory>
#include <string>

namespace bris {

/// Steps that a simulation has run in this process.
struct StepCount {
    std::uint64_t steps = 0;
    double wall_time = 0; ///< s, within `advance`
};

/// How a world is divided among the ranks of a run.
struct Division {
    /// This rank's part of the whole world, which all ranks have, and from which what the parts
    /// have is removed.
    World (*take)(World& whole) = nullptr;
    /// Makes the whole world of each rank again, of the State of all parts.
    void (*give_back)(const World& part, World& whole) = nullptr;
    /// Whether the next step needs the whole world. All ranks ask before each step, of their parts
    /// or of the whole, and find the same.
    bool (*whole_step_is_due)(const World& world) = nullptr;
    /// Rows of a table that this rank has to give of its part (StateOfWorld).
    StateOfWorld::RowsOfPart rows_to_save = nullptr;
    /// Whether sums over the parts are those over the whole (Simulation::observe).
    bool (*can_be_observed)(const World& part) = nullptr;
};

/// A world with its schedule and threads. The world must hold a Clock and a Health.
///
/// On several ranks (`divide`) every rank begins with the whole world, and all call the same
/// functions. `advance` computes the steps on the parts, but those that need it and the last one on
/// the whole world, so that whoever looks finds there what they would find without ranks, to the
/// same bits. While there are parts, the whole world has no bodies.
class Simulation {
public:
    Simulation(World world, StepList steps, unsigned threads = 1, ScheduleSettings settings = {});

    World& world() { return *world_; }
    const World& world() const { return *world_; }
    Schedule& schedule() { return schedule_; }

    /// Runs `steps` steps, on one thread if the world is too small for several. Throws
    /// SimulationError (step, time, reason) if a guard reports a problem.
    void advance(std::uint64_t steps = 1) {
        advance_unseen(steps);
        look();
    }
    /// The same where nobody looks at the world until `look` or `advance` is called: on several
    /// ranks it is not up to date before.
    void advance_unseen(std::uint64_t steps);
    /// Brings the world up to date after advance_unseen.
    void look();
    /// Completes advance_unseen where `observed` suffices, and on several ranks costs far less than
    /// `look`. If `look` follows in the same step, the world has its State, but not the records of
    /// contacts.
    void observe();
    /// The world after `observe`, with the records of contacts of the last step: on several ranks
    /// this rank's part of it, or the whole where the step needed it. Sums over bodies and contacts
    /// are sums over the ranks (OverRanks).
    const World& observed() const;
    /// Whether there are such records: not after steps that nobody observed or that failed.
    bool is_observed() const { return has_records_ && owed_ == 0; }
    std::uint64_t step() const; ///< number of the present step, up to date in any case
    const StepCount& count() const { return count_; }
    /// Seconds of each node so far, if timed: of the whole world, and of the parts that were given
    /// back.
    std::map<std::string, double> seconds() const;

    /// Divides the world among the ranks of the run while it advances.
    void divide(Division division) { division_ = division; }
    /// Divides it before the first step, so that no rank makes lists of the whole. Returns this
    /// rank's part; without ranks the whole.
    World& divide_now();
    /// This rank's part after advance_unseen; null while there is none.
    const World* part() const { return part_ ? &part_->world : nullptr; }
    /// Binds the schedule again after tables, columns or resources were added.
    void prepare() { schedule_.prepare(*world_); }

    /// The State after `look` or `observe`, until the next step: all ranks read it together, and it
    /// comes to the first one.
    StateOfWorld state() const;
    /// A copy of all State in memory, after `look`; `restore` puts it back to the same bits.
    Archive snapshot() const;
    void restore(const Archive& state);

    /// Registers a function that `restore` calls after the State was loaded, to rebuild derived
    /// data.
    void on_restore(void (*function)(World&)) { on_restore_ = function; }

private:
    /// What this rank computes while the world is divided.
    struct Part {
        Part(World taken, StepList steps, ScheduleSettings settings)
            : world(std::move(taken)), schedule(std::move(steps), settings) {
            schedule.prepare(world);
        }
        World world;
        Schedule schedule;
    };
    void advance_owed();
    void advance_part();
    void take_part();
    void give_back();
    template <class Steps>
    void stop_all_alike(Steps&& steps);
    void run(World& world, Schedule& schedule, std::uint64_t steps, bool observed,
             bool (*until)(const World&) = nullptr);

    std::unique_ptr<World> world_; // at a fixed address: bound systems point into it
    Division division_;
    std::unique_ptr<Part> part_; // null: the whole world is up to date
    std::uint64_t owed_ = 0;     // steps that have been asked for and not yet done
    bool has_records_ = true;    // of the contacts of the last step: what is observed
    StepList steps_;
    ScheduleSettings settings_;
    std::unique_ptr<Threads> threads_, alone_;
    Schedule schedule_;
    void (*on_restore_)(World&) = nullptr;
    StepCount count_;
    std::map<std::string, double> seconds_of_parts_;
};

} // namespace bris

#pragma once

#include "engine/archive.hpp"
#include "engine/clock.hpp"
#include "engine/progress.hpp"
#include "engine/scenario.hpp"
#include "engine/simulation.hpp"
#include "engine/stopwatch.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// What the loop of a run needs to know; every run of BRIS goes through `run_loop`.
struct LoopSteps {
    std::function<bool()> advance;           ///< one block of steps; false when there are no more
    std::function<PhaseProgress()> progress; ///< called after each block
    std::function<void()> save = {};         ///< writes a checkpoint; empty: nothing is saved
    std::string resume_hint =
        {}; ///< how the user goes on after an interruption, as "--resume FILE"
};

/// When the next checkpoint of a run is due: after `interval` seconds of wall time.
class CheckpointTimer {
public:
    explicit CheckpointTimer(double interval = 30) : interval_(interval) {}
    bool is_due() const { return seconds_since(last_) >= interval_; }
    void restart() { last_ = this_instant(); } ///< after writing: a slow disk gets its rest

private:
    double interval_; // s
    Instant last_ = this_instant();
};

/// The time loop: advances block by block until there is nothing more to do, reports progress,
/// saves checkpoints when they are due, and when the user asks to stop saves one and throws
/// Interrupted. None of it changes a bit of what is computed.
void run_loop(const LoopSteps& steps, CheckpointTimer& timer, const ReportProgress& report);

/// The line of progress of a scenario, with a slot for each run that goes on at once.
Progress make_progress(const Common& common, unsigned slots = 1);

/// One phase of a run.
struct Phase {
    /// Advances the simulation by one block of steps; false when the phase is over.
    std::function<bool(Simulation&)> advance;
    std::function<PhaseProgress(const World&)> progress;
    /// Called when the phase begins, not where a run is resumed within it.
    std::function<void(Simulation&)> begin = {};
};

/// A phase of given length with samples at equal intervals.
struct TimedPhase {
    std::string name;
    std::uint64_t steps = 0;        ///< length of the phase, > 0
    std::uint64_t sample_every = 0; ///< steps between samples, > 0
    /// Called at multiples of `sample_every` and at the end with the number of steps since the
    /// phase began; false ends the phase.
    std::function<bool(Simulation&, std::uint64_t step)> sample;
    std::function<std::string(const World&)> status = {}; ///< for the line of progress
    std::function<void(Simulation&)> begin = {};          ///< as in Phase
};

/// Steps of a duration (s) in time steps of `dt` (s), rounded. `option` names the duration in the
/// message. Throws InputError unless it is 1 to 1e15 steps.
std::uint64_t steps_of(double duration, double dt, const std::string& option);

/// One simulation from its first step to its last: the phases in their order, checkpoints
/// NAME.ckpt.h5 in the folder of the results, resuming to the same bits, interruption, and what is
/// known at the end of every run.
class Run {
public:
    /// `common`: folder, settings and name of the scenario that the checkpoints carry. The
    /// simulation has to outlive the run.
    Run(Simulation& simulation, const Common& common, const std::string& name,
        ReportProgress report);

    /// Saves an object beside the State of the world in every checkpoint, and loads it when the run
    /// is resumed: anything with `save(Archive&)` and `load(const Archive&)`. It has to outlive the
    /// run.
    template <class T>
    void keep(T& kept) {
        kept_.push_back({[&kept](Archive& archive) { kept.save(archive); },
                         [&kept](const Archive& archive) { kept.load(archive); }});
    }

    /// Goes on from a checkpoint, or from the last one in a folder; settings in `may_differ` may
    /// have changed since. Throws InputError, OutputError.
    void resume(const std::filesystem::path& path,
                const std::vector<std::string_view>& may_differ = {});
    bool is_resumed() const { return resumed_; }

    /// Runs the phases (the rest of them where it was resumed) and saves a last checkpoint. Where a
    /// guard stops the run its state is saved as NAME.stopped.ckpt.h5, and the message names the
    /// file. Throws SimulationError, Interrupted, OutputError.
    void go(const std::vector<Phase>& phases);
    /// The phase of `go` that takes a number of steps.
    Phase timed(TimedPhase phase) const;

    /// For a timed phase that a checkpoint may have finished already: throws InputError, naming the
    /// option of its duration, unless more than what was done is asked for.
    void require_steps_left(std::uint64_t steps, const std::string& option) const;

    void save() { save_as(name_); }
    /// The same as another file NAME.ckpt.h5 in the folder of the results.
    void save_as(const std::string& name) const;
    std::uint64_t phase() const { return position_.phase; } ///< at hand, in the list given to `go`
    /// Steps since the phase at hand began.
    std::uint64_t steps_in_phase() const { return clock().step - position_.first_step; }
    /// A file in the folder of the results, for what cannot be appended to the one of before:
    /// NAME.EXT, of a resumed run NAME_from_N.EXT with the step within the phase.
    std::filesystem::path file(const std::string& name, const std::string& extension) const;

    /// Adds what is known of every run: steps of the last phase, wall times, fingerprint of the State.
    void describe(Summary& summary) const;

private:
    struct Kept {
        std::function<void(Archive&)> save;
        std::function<void(const Archive&)> load;
    };
    /// Where the run is in the list of its phases.
    struct Position {
        std::uint64_t phase = 0, first_step = 0;
        bool begun = false;
    };
    const Clock& clock() const { return std::as_const(simulation_).world().resource<Clock>(); }
    std::filesystem::path checkpoint_file(const std::string& name) const {
        return common_.out / (name + ".ckpt.h5");
    }

    Simulation& simulation_;
    Common common_;
    std::string name_;
    ReportProgress report_;
    CheckpointTimer timer_;
    std::vector<Kept> kept_;
    Position position_;
    bool resumed_ = false;
    Instant began_ = this_instant();
};

} // namespace bris

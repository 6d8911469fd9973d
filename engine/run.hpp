#pragma once

#include "engine/archive.hpp"
#include "engine/clock.hpp"
#include "engine/progress.hpp"
#include "engine/scenario.hpp"
#include "engine/simulation.hpp"
#include "engine/stopwatch.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// Callbacks of the time loop; every run of BRIS goes through `run_loop`.
struct LoopSteps {
    std::function<bool()> advance;           ///< runs one block of steps; false: no more steps
    std::function<PhaseProgress()> progress; ///< called after each block
    std::function<void()> save = {};         ///< writes a checkpoint; empty: nothing is saved
    /// Option with which the user continues after an interruption, as "--resume FILE".
    std::string resume_hint = {};
};

/// Determines when the next checkpoint is due: after `interval` seconds of wall time.
class CheckpointTimer {
public:
    explicit CheckpointTimer(double interval = 30) : interval_(interval) {}
    bool is_due() const { return seconds_since(last_) >= interval_; }
    /// Called after writing, so that checkpoints on a slow disk do not follow each other at once.
    void restart() { last_ = this_instant(); }

private:
    double interval_; // s
    Instant last_ = this_instant();
};

/// The time loop: advances block by block until there are no more steps, reports progress and saves
/// checkpoints when they are due. When the user asks to stop, it saves a checkpoint and throws
/// Interrupted. None of this changes a bit of the computed results.
void run_loop(const LoopSteps& steps, CheckpointTimer& timer, const ReportProgress& report);

/// The progress line of a scenario.
Progress make_progress(const Common& common);

/// Runs independent short cases one after the other by the same loop: with progress, and stopping
/// between two of them when the user asks to (throws Interrupted).
void run_cases(const Common& common, const std::vector<std::string>& names,
               const std::function<void(std::size_t number)>& run);

/// One phase of a run.
struct Phase {
    /// Advances the simulation by one block of steps; returns false when the phase is over.
    std::function<bool(Simulation&)> advance;
    std::function<PhaseProgress(const World&)> progress;
    /// Called when the phase begins, but not when a run is resumed within it.
    std::function<void(Simulation&)> begin = {};
};

/// A phase with a given number of steps and samples at equal intervals.
struct TimedPhase {
    std::string name;
    std::uint64_t steps = 0;        ///< length of the phase, > 0
    std::uint64_t sample_every = 0; ///< steps between samples, > 0
    /// Called at multiples of `sample_every` and at the end, with the number of steps since the
    /// phase began; returning false ends the phase.
    std::function<bool(Simulation&, std::uint64_t step)> sample;
    std::function<std::string(const World&)> status = {}; ///< for the progress line
    std::function<void(Simulation&)> begin = {};          ///< see Phase
    bool looks = true; ///< before each sample; else `sample` calls Simulation::look or observe
};

/// Number of time steps `dt` (s) in a `duration` (s), rounded. `option` names the duration in the
/// message. Throws InputError unless the result is 1 to 1e15 steps.
std::uint64_t steps_of(double duration, double dt, const std::string& option);

/// One simulation from its first step to its last: runs the phases in order, writes checkpoints
/// NAME.ckpt.h5 to the folder of results, resumes them to the same bits, handles interruption, and
/// adds general results to the summary.
class Run {
public:
    /// `common`: folder of results, settings and scenario name that the checkpoints carry. The
    /// simulation must outlive the run.
    Run(Simulation& simulation, const Common& common, const std::string& name,
        ReportProgress report);
    /// A run with a progress line of its own.
    Run(Simulation& simulation, const Common& common, const std::string& name);

    /// Saves an object beside the State of the world in every checkpoint, and loads it when the run
    /// is resumed. The object has `save(Archive&)` and `load(const Archive&)` and must outlive the
    /// run.
    template <class T>
    void keep(T& kept) {
        kept_.push_back({[&kept](Archive& archive) { kept.save(archive); },
                         [&kept](const Archive& archive) { kept.load(archive); }});
    }

    /// Continues from a checkpoint, or from the last one in a folder. Settings in `may_differ` may
    /// have changed since it was written. Throws InputError, OutputError.
    void resume(const std::filesystem::path& path,
                const std::vector<std::string_view>& may_differ = {});
    bool is_resumed() const { return resumed_; }

    /// Runs the phases (after resuming, those that remain) and saves a last checkpoint. If a guard
    /// stops the run, the state is saved as NAME.stopped.ckpt.h5 and the message names the file.
    /// Throws SimulationError, Interrupted, OutputError.
    void go(const std::vector<Phase>& phases);
    /// A timed phase in the form that `go` takes.
    Phase timed(TimedPhase phase) const;

    /// Checks a timed phase that the checkpoint may already have completed: throws InputError,
    /// naming the option of its duration, if `steps` are fewer than the steps done.
    void require_steps_left(std::uint64_t steps, const std::string& option) const;

    void save() { save_as(name_); }
    /// Saves a checkpoint as NAME.ckpt.h5 in the folder of results.
    void save_as(const std::string& name) const;
    /// index of the current phase in the list given to `go`
    std::uint64_t phase() const { return position_.phase; }
    /// Steps since the current phase began.
    std::uint64_t steps_in_phase() const { return simulation_.step() - position_.first_step; }
    /// A file NAME.EXT in the folder of results that cannot be appended to when a run is resumed:
    /// after resuming it is NAME_from_N.EXT, where N is the step within the phase.
    std::filesystem::path file(const std::string& name, const std::string& extension) const;

    /// Steps of this run in this process.
    StepCount count() const;

    /// Adds the results that every run has: steps of the last phase, wall times, and the
    /// fingerprint of the State.
    void add_to_summary(Summary& summary) const;

private:
    struct Kept {
        std::function<void(Archive&)> save;
        std::function<void(const Archive&)> load;
    };
    /// Position of the run in the list of phases.
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
    std::unique_ptr<Progress> progress_; // null if the run shares a line with others
    ReportProgress report_;
    CheckpointTimer timer_;
    std::vector<Kept> kept_;
    Position position_;
    bool resumed_ = false;
    Instant began_ = this_instant();
    StepCount count_before_; ///< of the simulation, when the run began
};

} // namespace bris

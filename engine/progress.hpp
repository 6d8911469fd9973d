#pragma once

#include <cstdio>
#include <functional>
#include <memory>
#include <string>

namespace bris {

/// Progress of a run within one of its phases.
struct PhaseProgress {
    std::string phase;       ///< name, as "shear"; empty: the run has ended
    double fraction = 0;     ///< of the phase, 0 to 1; below 0: unknown
    std::string status = {}; ///< current figures, as "axial strain 3.2 of 8 %, q 540 kPa"
    double work = 0;         ///< done by the run so far, in the unit of Progress::begin_job
};

/// Shows the progress of runs to the user: one rewritten line on a terminal, otherwise a line every
/// ten seconds (on stderr), nothing when quiet. Several runs may be shown at once, each in its own
/// slot; any thread may call any member. The estimated time left (ETA) is that of the job that
/// these runs are parts of, or without a job that of the current phase of each run, from the rate
/// measured over about the last tenth. A line that is too long for the terminal is shown without
/// the status of the runs.
class Progress {
public:
    /// How progress is shown; `automatic` checks whether stderr is a terminal.
    enum class Style { automatic, rewritten, lines, quiet };
    explicit Progress(Style style = Style::automatic, std::FILE* out = stderr);
    ~Progress(); ///< clears the line on a terminal

    /// Begins a job of many runs: `work` is that of all of them, in any unit.
    void begin_job(double work);
    /// Sets the work done by the runs of the job that have ended, which may differ from what they
    /// reported: some resume from a checkpoint, others are stopped.
    void job_reached(double work);

    /// Reports that run `slot` is at `now`; a run that has ended is no longer shown. Runs that are
    /// in progress at the same time need slots of their own. Cheap when no
    /// output is due (at most two lines per second on a terminal).
    void report(unsigned slot, const PhaseProgress& now);

    /// Clears the line on a terminal, so that other text can follow; the next report shows it
    /// again.
    void pause();

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Receiver of progress reports.
using ReportProgress = std::function<void(const PhaseProgress&)>;

/// Sends reports to a slot of `progress`, which must outlive the returned function.
inline ReportProgress progress_slot(Progress& progress, unsigned slot = 0) {
    return [&progress, slot](const PhaseProgress& now) { progress.report(slot, now); };
}

} // namespace bris

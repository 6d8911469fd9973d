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
    std::string status = {}; ///< current figures, as "axial strain 3.2 %, q 540 kPa"
};

/// Shows the progress of runs to the user: one rewritten line on a terminal, otherwise a line every
/// ten seconds (on stderr), nothing when quiet. Several runs may be shown at once, each in its own
/// slot; any thread may call any member. The estimated time left (ETA) is that of the current
/// phase, from the rate measured over about its last tenth.
class Progress {
public:
    /// How progress is shown; `automatic` checks whether stderr is a terminal.
    enum class Style { automatic, rewritten, lines, quiet };
    explicit Progress(unsigned slots = 1, Style style = Style::automatic, std::FILE* out = stderr);
    ~Progress(); ///< ends an open line on the terminal

    /// Reports that run `slot` is at `now`; a run that has ended is no longer shown. Cheap when no
    /// output is due (at most two lines per second on a terminal).
    void report(unsigned slot, const PhaseProgress& now);

    /// Ends the line on a terminal, so that other text can follow; the next report begins a new
    /// line.
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

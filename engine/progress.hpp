#pragma once

#include <cstdio>
#include <functional>
#include <memory>
#include <string>

namespace bris {

/// Where a run stands within one of its phases.
struct PhaseProgress {
    std::string phase;       ///< name, as "shear"; empty: the run is over
    double fraction = 0;     ///< of the phase, 0 to 1; below 0: nobody can know
    std::string status = {}; ///< what is going on in numbers, as "axial strain 3.2 %, q 540 kPa"
};

/// Tells the user how far runs are: one rewritten line on a terminal, a line every ten seconds
/// elsewhere (on stderr), nothing when quiet. Several runs may go on at once, each with a slot of
/// its own; any thread may call any member. The time left (ETA) is that of the phase at hand, from
/// the rate measured over its last tenth or so.
class Progress {
public:
    /// How the lines reach the user; the default asks stderr whether it is a terminal.
    enum class Style { automatic, rewritten, lines, quiet };
    explicit Progress(unsigned slots = 1, Style style = Style::automatic, std::FILE* out = stderr);
    ~Progress(); ///< leaves the terminal at the start of a fresh line

    /// Run `slot` stands at `now`; one that is over is shown no longer. Cheap when nothing is due
    /// to be shown (two lines per second on a terminal).
    void report(unsigned slot, const PhaseProgress& now);

    /// Ends the line on a terminal, so that other text can follow; the next report opens a new one.
    void pause();

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Whoever wants to know how far a run is.
using ReportProgress = std::function<void(const PhaseProgress&)>;

/// Reports to a slot of the line of progress, which has to outlive it.
inline ReportProgress progress_slot(Progress& progress, unsigned slot = 0) {
    return [&progress, slot](const PhaseProgress& now) { progress.report(slot, now); };
}

} // namespace bris

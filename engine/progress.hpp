#pragma once

#include <cstdio>
#include <memory>
#include <string>

namespace bris {

/// Tells the user how far a run is: one rewritten line on a terminal, a line every ten seconds
/// elsewhere (on stderr), nothing when quiet. Several worlds may run at once, each with a slot of
/// its own; any thread may call any member.
class Progress {
public:
    /// How the lines reach the user; the default asks stderr whether it is a terminal.
    enum class Style { automatic, rewritten, lines, quiet };
    explicit Progress(unsigned slots = 1, Style style = Style::automatic, std::FILE* out = stderr);
    ~Progress(); ///< leaves the terminal at the start of a fresh line

    /// World `slot` is at `fraction` (0 to 1) of its run and doing `text`, as "shear 3.2 %, step
    /// 120000". Cheap when nothing is due to be shown (two per second on a terminal).
    void report(unsigned slot, double fraction, const std::string& text);

    /// Ends the line on a terminal, so that other text can follow; the next report opens a new one.
    void pause();

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace bris

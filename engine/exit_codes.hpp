#pragma once

#include <array>
#include <utility>

namespace bris {

/// Exit code of the process.
enum class ExitCode : int {
    done = 0,
    internal_error = 1,
    bad_input = 2,
    failed = 3,
    io_failure = 4,
    not_judged = 5,
    interrupted = 130
};

/// What the exit codes mean. --help, README.md and scenarios/README.md say this in the same words.
inline constexpr std::array<std::pair<ExitCode, const char*>, 7> exit_codes{
    {{ExitCode::done, "done"},
     {ExitCode::internal_error, "an error of the program itself"},
     {ExitCode::bad_input, "bad input: one line with the option or file:line, what was expected "
                           "and what was found"},
     {ExitCode::failed,
      "the computation failed: a numerical guard stopped it, a state was not reached, memory ran "
      "out, or a check of verify or stress failed"},
     {ExitCode::io_failure, "a file could not be read or written"},
     {ExitCode::not_judged, "monitor --require all: not everything that was recorded was judged"},
     {ExitCode::interrupted, "interrupted; runs that can be resumed have saved a checkpoint"}}};

} // namespace bris

#pragma once

#include "tests/temporary_directory.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <sys/types.h>
#include <vector>

namespace bris {

/// How a process ended.
struct Outcome {
    int code = -1;     ///< exit code; -1: ended by a signal or not started
    int signal = 0;    ///< that ended it
    bool hung = false; ///< it was killed, because it did not end in time
    double seconds = 0;
    double processor_time = 0; ///< s
    std::string out, err;
};

/// A program of build/bin in a process of its own, whose output is kept.
class Process {
public:
    /// `words`: name of the program and its arguments. `prepare` is called in the new process
    /// before the program is loaded, and returns whether the program may start.
    explicit Process(const std::vector<std::string>& words,
                     const std::function<bool()>& prepare = {});
    ~Process(); ///< kills it if it still runs

    pid_t id() const { return id_; }
    /// Waits for the program to begin: before, a signal would meet a copy of the tests.
    void send(int signal) const;
    /// Waits until the end, at most `seconds`; then the process is killed.
    Outcome wait(double seconds);
    /// Processor time that it has used so far, s.
    double processor_time() const;
    /// The outcome of a process that somebody else has waited for, with its status.
    Outcome ended(int status, bool hung);

private:
    TemporaryDirectory folder_; // of the output
    pid_t id_ = 0;
    int begun_ = -1; // of a pipe that is closed when the program begins
    double began_ = 0;
    bool ended_ = false;
};

/// Runs a program to its end.
Outcome run_process(const std::vector<std::string>& words,
                    const std::function<bool()>& prepare = {}, double seconds = 60);

/// One line, which begins with the name of the program.
bool is_one_line_of(const std::string& text, const std::string& program);

} // namespace bris

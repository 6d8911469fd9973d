#pragma once

#include "engine/interrupt.hpp"

#include <atomic>
#include <filesystem>
#include <string>
#include <sys/types.h>
#include <vector>

namespace bris {

/// The file of the program that runs; empty if the system does not say.
std::filesystem::path this_program();

/// A program in a process of its own. SIGTERM ends it with the object (SIGKILL, if that takes 20
/// s), and where a request to stop ends this program.
class ChildProgram {
public:
    struct Settings {
        int input = -1, output = -1; ///< open files; -1: those of this program
        bool is_silent = false;      ///< its messages of errors are lost
        bool own_group = false;      ///< a process group of its own, which Ctrl-C does not reach
    };
    /// `words`: the program, found along PATH, and its arguments. Throws OutputError if it cannot
    /// be started.
    explicit ChildProgram(const std::vector<std::string>& words)
        : ChildProgram(words, Settings()) {}
    ChildProgram(const std::vector<std::string>& words, const Settings& settings);
    ~ChildProgram();
    ChildProgram(const ChildProgram&) = delete;

    /// Whether it still runs.
    bool runs();
    /// Waits until it ends. Returns its exit code.
    int wait();
    void send(int signal) const;
    /// Exit code of the ended program, 128 + N if signal N ended it; -1: it still runs.
    int exit_code() const { return code_; }

private:
    void note_end(int status);

    std::atomic<pid_t> id_ = 0; // 0: it has ended
    int code_ = -1;
    Cleanup cleanup_;
};

} // namespace bris

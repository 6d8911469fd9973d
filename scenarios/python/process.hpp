#pragma once

#include <pybind11/pybind11.h>

// What the process does to simulations: it ends while a thread runs steps, and it is forked.

namespace bris {

/// To be called once, when the module is imported. At the end of the interpreter, threads that run
/// steps are stopped between two of them and waited for: a thread that returned later would find
/// neither Python nor the engine.
void watch_process();

/// Lets other Python threads run for as long as it lives.
class WithoutLock {
public:
    WithoutLock();
    WithoutLock(const WithoutLock&) = delete;
    WithoutLock& operator=(const WithoutLock&) = delete;
    ~WithoutLock();

private:
    PyThreadState* state_;
};

/// To be called between two steps, with Python's lock. Throws pybind11::error_already_set with
/// KeyboardInterrupt after Ctrl-C, with what another signal handler has raised, and with SystemExit
/// in a thread that would go on after the end of the interpreter.
void require_going_on();

/// To be called before work on several threads. Throws std::runtime_error in a process that was
/// forked after such work: the threads are not copied, and the work would wait for them for ever.
void require_threads();

} // namespace bris

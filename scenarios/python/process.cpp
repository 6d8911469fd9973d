#include "scenarios/python/process.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <pthread.h>
#include <stdexcept>
#include <thread>
#include <unistd.h>

namespace bris {

namespace py = pybind11;

namespace {

// of the process; Python's lock guards them
int unlocked = 0;          // threads that run steps
bool is_ending = false;    // the interpreter calls its exit functions
std::thread::id ending;    // the thread that does
bool has_threads = false;  // there has been work on several threads
bool lost_threads = false; // before this process was forked

void after_fork_in_child() { // only the thread that has forked is copied
    unlocked = 0;
    lost_threads = lost_threads || has_threads;
    // exit functions of libraries (log4cplus, of OpenVDB) wait for threads that were not copied
    on_exit(
        [](int status, void*) {
            std::fflush(nullptr);
            _exit(status);
        },
        nullptr);
}

void end_of_interpreter() {
    is_ending = true;
    ending = std::this_thread::get_id();
    while (unlocked > 0) {
        const py::gil_scoped_release release;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

} // namespace

void watch_process() {
    pthread_atfork(nullptr, nullptr, after_fork_in_child);
    py::module_::import("atexit").attr("register")(py::cpp_function(end_of_interpreter));
}

WithoutLock::WithoutLock() {
    ++unlocked;
    state_ = PyEval_SaveThread();
}

WithoutLock::~WithoutLock() {
    PyEval_RestoreThread(state_);
    --unlocked;
}

void require_going_on() {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!is_ending || std::this_thread::get_id() == ending) return;
    PyErr_SetString(PyExc_SystemExit, "the interpreter ends");
    throw py::error_already_set();
}

void require_threads() {
    if (lost_threads)
        throw std::runtime_error("this process was forked after its parent had computed on several "
                                 "threads, which a fork does not copy: start processes with the "
                                 "method 'spawn' of multiprocessing, or use one thread");
    has_threads = true;
}

} // namespace bris

#pragma once

#include "tests/scenarios/faults/process.hpp"

namespace bris {

/// What happens to a call that writes.
enum class Fault {
    none,        ///< calls are only counted
    short_write, ///< half of the bytes are written; the call says so and does not fail
    no_space,    ///< the call fails with ENOSPC, later ones do not
    io_error,    ///< the call fails with EIO, later ones do not
    disk_full    ///< all calls from this one on that make a file longer fail with ENOSPC
};

/// A run in which one call to the operating system failed.
struct FaultyRun {
    Outcome outcome;
    unsigned calls = 0;     ///< number of calls to which the fault may happen
    std::string call, file; ///< the first one to which it happened; empty: none
};

/// Runs a program (`words`: see Process) while the calls by which it writes files in `folder` are
/// watched, those of libraries included: opening for writing, write, change of length, fsync and
/// rename. The fault happens to the `number`-th of them, counted from 1. Works by ptrace and
/// seccomp, on Linux for x86-64. `prepare`: see Process. A run that takes more than `seconds` is
/// killed.
FaultyRun run_with_fault(const std::vector<std::string>& words, const std::filesystem::path& folder,
                         Fault fault, unsigned number, const std::function<bool()>& prepare = {},
                         double seconds = 30);

/// The reason for which this machine cannot watch calls; empty: it can.
std::string why_no_faults();

} // namespace bris

#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace bris {

/// An invalid option, asset or recording. The message is one line: "file:line: what: expected ...,
/// found ...".
struct InputError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The computation failed. The message of a numerical guard names the step, the time, the ids
/// involved and what to try.
struct SimulationError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A file cannot be read or written.
struct OutputError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The user asked to stop (Ctrl-C); the state has been saved.
struct Interrupted : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Throws InputError unless `condition` holds.
inline void require(bool condition, const std::string& message) {
    if (!condition) throw InputError(message);
}

} // namespace bris

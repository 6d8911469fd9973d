#pragma once

#include "engine/printable.hpp"

#include <cstdint>
#include <stdexcept>
#include <string>

namespace bris {

/// An error with a message that a terminal can show. Bytes of a file that it cites are made
/// printable: at a zero byte, the text of an exception would end.
struct Error : std::runtime_error {
    explicit Error(const std::string& message) : std::runtime_error(printable(message)) {}
};

/// An invalid option, asset or recording. The message is one line: "file:line: what: expected ...,
/// found ...".
struct InputError : Error {
    using Error::Error;
};

/// The computation failed. The message of a numerical guard names the step, the time, the ids
/// involved and what to try.
struct SimulationError : Error {
    using Error::Error;
};

/// A file cannot be read or written.
struct OutputError : Error {
    using Error::Error;
};

/// The user asked to stop (Ctrl-C); the state has been saved.
struct Interrupted : Error {
    using Error::Error;
};

/// Throws InputError unless `condition` holds.
inline void require(bool condition, const std::string& message) {
    if (!condition) throw InputError(message);
}

} // namespace bris

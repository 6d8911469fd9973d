#pragma once

namespace bris {

/// Names of the instructions that this binary was compiled for and that the compiler uses by
/// itself, as g++ names them, up to a null pointer. Empty where they are those of every such
/// processor.
namespace detail {
extern const char* const needed_instructions[];
} // namespace detail

/// Whether this processor, and the system on it, has the instructions of that name; true for names
/// that are not known.
bool has_instructions(const char* name);

} // namespace bris

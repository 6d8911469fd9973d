#pragma once

#include <string_view>

namespace bris {

/// Prints one line to stderr, as a terminal can show it (printable). Does not throw: where stderr
/// is closed or full, nobody reads it, and the run goes on.
void say(std::string_view line);

} // namespace bris

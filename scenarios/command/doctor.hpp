#pragma once

#include <string>

namespace bris {

/// What this machine and this build have of what BRIS uses, a line for each, and what is lost
/// where something is missing.
std::string examine();

} // namespace bris

#pragma once

#include <string>

namespace bris {

/// Of this binary, with its version.
inline std::string compiler() {
#ifdef __clang__
    return "clang " __clang_version__;
#else
    return "g++ " __VERSION__;
#endif
}

} // namespace bris

#pragma once

#include <string>

namespace bris {

/// Name and version of the compiler of this binary.
inline std::string compiler() {
#ifdef __clang__
    return "clang " __clang_version__;
#else
    return "g++ " __VERSION__;
#endif
}

} // namespace bris

#pragma once

#include <fstream>
#include <string>

namespace bris {

/// Name of the processor; "unknown" where the system does not say.
inline std::string processor() {
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);)
        if (line.starts_with("model name") && line.find(": ") != std::string::npos)
            return line.substr(line.find(": ") + 2);
    return "unknown";
}

} // namespace bris

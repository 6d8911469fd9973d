#pragma once

#include "engine/scenario.hpp"

#include <filesystem>

namespace bris::testing {

/// Common options of a run of this scenario on one thread that prints nothing.
inline Common quiet_run(const char* scenario, const std::filesystem::path& out) {
    Common common;
    common.scenario = scenario;
    common.out = out;
    common.threads = 1;
    common.quiet = true;
    return common;
}

} // namespace bris::testing

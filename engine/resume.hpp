#pragma once

#include "engine/io/checkpoint.hpp"
#include "engine/simulation.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// Reads a checkpoint (in a folder of results, the one written last) and restores its State in the
/// simulation. Rejects checkpoints of another scenario or with other settings, except for settings
/// in `may_differ` and settings_that_may_differ(). Returns the checkpoint, for the other data saved
/// in it. Throws InputError, OutputError.
Checkpoint resume(Simulation& simulation, const std::filesystem::path& path,
                  const std::string& scenario, const std::vector<NamedValue>& settings,
                  const std::vector<std::string_view>& may_differ = {});

} // namespace bris

#pragma once

#include "engine/io/checkpoint.hpp"
#include "engine/simulation.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// Reads the checkpoint that an option names (in a folder of results, the one written last).
/// Rejects checkpoints of another scenario or with other settings, except for settings in
/// `may_differ` and settings_that_may_differ(). Throws InputError, OutputError.
Checkpoint checkpoint_to_resume(const std::filesystem::path& path, const std::string& scenario,
                                const std::vector<NamedValue>& settings,
                                const std::vector<std::string_view>& may_differ = {},
                                const std::string& option = "--resume");

/// The same, and restores its State in the simulation. Returns the checkpoint, for the other data
/// saved in it.
Checkpoint resume(Simulation& simulation, const std::filesystem::path& path,
                  const std::string& scenario, const std::vector<NamedValue>& settings,
                  const std::vector<std::string_view>& may_differ = {},
                  const std::string& option = "--resume");

} // namespace bris

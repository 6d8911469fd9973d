#pragma once

#include "engine/io/checkpoint.hpp"
#include "engine/simulation.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// Reads a checkpoint (of a folder of results the one written last) and puts its State into the
/// simulation. Refuses the checkpoint of another scenario or of other settings; those in
/// `may_differ`, besides the ones that always may, are left out. Returns it, for what else was
/// saved in it. Throws InputError, OutputError.
Checkpoint resume(Simulation& simulation, const std::filesystem::path& path,
                  const std::string& scenario, const std::vector<NamedValue>& settings,
                  const std::vector<std::string_view>& may_differ = {});

} // namespace bris

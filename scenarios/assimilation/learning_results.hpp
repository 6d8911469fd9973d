#pragma once

#include "engine/named_value.hpp"
#include "scenarios/assimilation/learning.hpp"

#include <filesystem>
#include <vector>

namespace bris {

/// Friction and stiffness with their deviations, flat keys for summary.json.
std::vector<NamedValue> describe(const Gaussian& estimate);

/// A line for each window: what was known at its end. Throws OutputError.
void write_estimates(const std::filesystem::path& csv, const std::vector<EstimateAt>& estimates);

/// What each world foretold of q, stage by stage. Throws OutputError.
void write_members(const std::filesystem::path& csv, const Ensemble& members);

} // namespace bris

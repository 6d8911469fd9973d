#pragma once

#include "engine/named_value.hpp"
#include "scenarios/ensemble/learning.hpp"

#include <filesystem>
#include <vector>

namespace bris {

/// The estimate of friction and stiffness with standard deviations, as flat keys for summary.json.
std::vector<NamedValue> named_values_of(const Gaussian& estimate);

/// Writes a CSV file with the parameter estimate at the end of each window. Throws OutputError.
void write_estimates(const std::filesystem::path& csv, const std::vector<EstimateAt>& estimates);

/// Writes a CSV file with the q that each ensemble member forecasts, stage by stage. Throws
/// OutputError.
void write_members(const std::filesystem::path& csv, const Ensemble& members);

} // namespace bris

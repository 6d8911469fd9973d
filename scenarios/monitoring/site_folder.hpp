#pragma once

#include "scenarios/monitoring/passage.hpp"

#include <cstddef>
#include <filesystem>

namespace bris {

/// Adds a passage to a folder of passages (read_passages), with a number before its name that keeps
/// the order in which they came, its cause in passages.csv, and the metadata of sensors that the
/// folder has not. Returns false, and adds nothing, if the folder has it already. Throws InputError
/// if the sensor's metadata there have another rate, OutputError.
bool keep_passage(const std::filesystem::path& folder, const Passage& passage);

} // namespace bris

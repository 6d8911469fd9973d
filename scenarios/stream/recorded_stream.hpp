#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// Converts a recorded test (recordings.csv and test.csv of a folder) into the lines of a stream,
/// in order of strain. Records of the machine keep their own `t`; if test.csv has no `t`, it starts
/// at `rest` (s) and increases by `stage_time` (s) per 0.01 % of axial strain. Throws InputError,
/// OutputError.
std::vector<std::string> stream_of(const std::filesystem::path& folder, double stage_time,
                                   double rest);

} // namespace bris

#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// A recorded test (recordings.csv and test.csv of a folder) as the lines of a stream, in the order
/// of strain. Of the machine with its own `t`; where test.csv has none, `stage_time` (s) for 0.01 %
/// of strain after `rest` (s). Throws InputError, OutputError.
std::vector<std::string> stream_of(const std::filesystem::path& folder, double stage_time,
                                   double rest);

} // namespace bris

#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

struct KnownColumn;

/// A column map as guessed from a CSV file of another make (column_map.hpp).
struct GuessedMap {
    std::string map;                ///< text of the map, to be read with read_column_map
    std::vector<std::string> notes; ///< what was guessed from what, one sentence each
    std::vector<std::string> found; ///< columns that have been recognised, by their names in BRIS
};

/// Guesses delimiter, decimal sign, the line of the names, and which column is which, from usual
/// names ("AccX (g)", "Gyro Y [dps]", "Timestamp_ms") and, for times and accelerations without a
/// unit, from the size of the numbers. `known`: recording_columns() or machine_columns(). Columns
/// that are not recognised are named in a note. Throws InputError if no line looks like column
/// names above numbers; OutputError if the file cannot be read.
GuessedMap guess_columns(const std::filesystem::path& csv, const std::vector<KnownColumn>& known);

} // namespace bris

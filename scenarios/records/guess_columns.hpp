#pragma once

#include "scenarios/records/unit_evidence.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// A column map as guessed from a CSV file of another make (column_map.hpp).
struct GuessedMap {
    /// Text of the map, to be read with read_column_map. A unit that has to be given is "?" in it,
    /// which read_column_map refuses.
    std::string map;
    std::vector<std::string> notes;  ///< what was guessed from what, one sentence each
    std::vector<std::string> found;  ///< columns that have been recognised, by their names in BRIS
    std::vector<std::string> titles; ///< all columns of the file, in quotes
    std::vector<std::string> open;   ///< those of `found` whose unit has to be given, and why
    double rate = 0; ///< Hz, sampling rate that the file states above its table; 0: none
};

/// Guesses delimiter, decimal sign, the line of the names, which column is which, and the units. A
/// unit that the name of a column states ("AccX (g)", "Gyro Y [dps]", "Timestamp_ms"), or the line
/// below the names, is taken as it is. Where none is stated, one is taken only if it alone fits
/// what else is known (possible_units). In all other cases, and if the word is not known, the unit
/// is open. `known`: recording_columns() or machine_columns(). Throws InputError if no line looks
/// like column names above numbers; OutputError if the file cannot be read.
GuessedMap guess_columns(const std::filesystem::path& csv, const std::vector<KnownColumn>& known,
                         FileEvidence evidence = {});

/// Writes the map of a guess, to be checked and corrected. Throws InputError if a unit has to be
/// given in it; OutputError.
void write_guessed_map(const std::filesystem::path& csv, const GuessedMap& guess,
                       const std::filesystem::path& map);

} // namespace bris

#pragma once

#include <filesystem>
#include <string>

namespace bris {

/// Settings of a new folder of recordings.
struct NewRecordings {
    std::filesystem::path sensors; ///< CSV file of another make with the samples of the sensors
    std::filesystem::path machine; ///< CSV file with those of the test machine; empty: none
    double pressure = 55e3;        ///< Pa, confining
    std::filesystem::path folder;
};

/// Writes the skeleton of a folder of recordings: a copy of the samples as 55kPa/recordings.csv,
/// columns.txt with the guessed column map, rock_NN.txt for each sensor id (sampling rate from the
/// times, attitude as recorded or from the direction of gravity, all else as of a usual sensor),
/// and for the machine 55kPa/test.csv and machine_columns.txt. Returns what was guessed and what is
/// still to be given, a sentence a line. Throws InputError, naming the columns of the file, if one
/// that is needed is not found; if a unit has to be given (the column map is kept, with "?" in its
/// place); if times do not advance; or if the folder holds recordings already. OutputError.
std::string write_new_recordings(const NewRecordings& settings);

} // namespace bris

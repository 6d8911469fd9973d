#pragma once

#include "scenarios/records/logger_file.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// Settings of a new folder of recordings.
struct NewRecordings {
    /// Files of another make with the samples of the sensors
    std::vector<std::filesystem::path> sensors;
    std::filesystem::path machine; ///< CSV file with those of the test machine; empty: none
    double pressure = 55e3;        ///< Pa, confining
    std::filesystem::path folder;
    LoggerSettings logger = {}; ///< of the files of sensors
};

/// Whether the files are one with a number of a sensor in each row, which a column map describes,
/// and the user says nothing of its columns and rate. Such a file is copied; others are converted.
bool is_described_by_map(const NewRecordings& settings);

/// Writes the skeleton of a folder of recordings: a copy of the samples as 55kPa/recordings.csv
/// with columns.txt, the guessed column map, or the samples of files that no such map describes in
/// the form of BRIS; rock_NN.txt for each sensor id (sampling rate from the times, attitude as
/// recorded or from the direction of gravity, all else as of a usual sensor), and for the machine
/// 55kPa/test.csv and machine_columns.txt. Returns what was guessed and what is still to be given,
/// a sentence a line. Throws InputError, naming the columns of the file, if one that is needed is
/// not found; if a unit has to be given (the column map is kept, with "?" in its place); if times
/// do not advance; or if the folder holds recordings already. OutputError.
std::string write_new_recordings(const NewRecordings& settings);

} // namespace bris

#pragma once

#include "scenarios/monitoring/passage.hpp"
#include "scenarios/records/logger_file.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace bris {

/// How a logger's files become passages.
struct PassageCutting {
    /// Each file holds one train and is taken as a whole.
    bool every_recording_holds_a_train = false;
    double quiet = 5;       ///< s without vibration that end a passage
    double margin = 1;      ///< s that a passage has before and after
    double long_file = 180; ///< s; a longer file is cut also if only one train passed
};

/// The files that are meant: these, and those in these folders and their subfolders that end with
/// csv, txt, tsv or log, in order of name, without metadata rock_NN.txt, column maps and reports.
/// Throws InputError if there is none, OutputError if a folder cannot be read.
std::vector<std::filesystem::path>
logger_files(const std::vector<std::filesystem::path>& files_or_folders, const std::string& option);

/// Reads a logger's files (read_logger_file) one after the other, those with dates in the order of
/// these, and takes their passages. Files of other sensors that overlap in time by dates are one.
/// One that is long or in which several trains passed is cut into NAME_01, NAME_02 ...; one in
/// which nothing stands out is one passage. Times begin at 0 in each passage. `option` names the
/// files in messages; `notes`: what was assumed and cut. Throws InputError, OutputError.
void for_each_logged_passage(const std::vector<std::filesystem::path>& files_or_folders,
                             const LoggerSettings& settings, const PassageCutting& cutting,
                             const std::string& option, const std::function<void(Passage&&)>& take,
                             std::vector<std::string>& notes);

} // namespace bris

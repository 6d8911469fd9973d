#pragma once

#include "scenarios/monitoring/logger_passages.hpp"
#include "scenarios/monitoring/passage.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace bris {

/// What a user names as recordings: a folder with metadata rock_NN.txt (read_passages), or files
/// and folders of loggers.
struct RecordingsNamed {
    std::string paths;  ///< separated by commas
    std::string option; ///< for messages
    LoggerSettings logger = {};
    PassageCutting cutting = {};

    std::vector<std::filesystem::path> list() const;
    /// Whether it is one folder with metadata, or with recordings.h5, which has them.
    bool is_own_folder() const;
};

/// Gives the passages one after the other, with the causes of passages.csv in the first folder.
/// `notes`: how files of loggers were read. Throws InputError, OutputError.
void for_each_passage(const RecordingsNamed& named, const std::function<void(Passage&&)>& take,
                      std::vector<std::string>& notes);

/// Files named one after the other after an option, as a shell gives them for *.csv, as one word
/// with commas.
std::vector<std::string> with_listed_files(const std::vector<std::string>& words,
                                           const std::vector<std::string>& options);

} // namespace bris

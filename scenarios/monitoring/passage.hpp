#pragma once

#include "scenarios/monitoring/passage_cause.hpp"
#include "scenarios/sensors/recording.hpp"

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace bris {

/// What all sensors recorded during one passage of a train, or in one window of a stream.
struct Passage {
    std::string name;
    std::vector<Recording> recordings; ///< one for each sensor of the metadata, perhaps empty
    /// Share of its time that a sensor recorded, whether it vibrated or not; empty: not known, as
    /// of files.
    std::map<unsigned, double> recorded = {};
    PassageCause cause = {}; ///< by passages.csv beside the recordings
};
/// From this share on a sensor has recorded a passage.
inline constexpr double all_recorded = 0.9;

/// Reads a folder of recordings: metadata rock_NN.txt, and a file recordings.csv for each passage,
/// in the folder itself and in its subfolders, in the order of their names; or files recordings.h5,
/// which may contain the metadata. `columns`: column map of the CSV files; empty: columns.txt in
/// the folder or, where it is not there, the format of BRIS. `option` names the folder in messages.
/// Throws InputError with file:line, and OutputError.
std::vector<Passage> read_passages(const std::filesystem::path& folder,
                                   const std::filesystem::path& columns, const std::string& option);
/// The same, one passage after the other, so that one is in memory at a time.
void for_each_passage(const std::filesystem::path& folder, const std::filesystem::path& columns,
                      const std::string& option, const std::function<void(Passage&&)>& take);

/// The metadata rock_NN.txt of a folder, in order of id; empty if there are none. Throws
/// InputError, OutputError.
std::vector<SensorInfo> sensor_infos_in(const std::filesystem::path& folder,
                                        const std::string& option);

/// Writes the metadata of the first passage, and NAME/recordings.csv for each. Throws OutputError.
void write_passages(const std::filesystem::path& folder, const std::vector<Passage>& passages,
                    const std::string& comment);

} // namespace bris

#pragma once

#include "scenarios/ballast_box/track_slice.hpp"
#include "scenarios/monitoring/train_fit.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// The compliance of a sensor rock in a passage, from its recording.
struct RecordedMovement {
    std::size_t sensor = 0; ///< index among those of the slice
    double compliance = 0;  ///< m/N, > 0
    double deviation = 0;   ///< m/N, standard deviation of its error
};

/// Errors of compliances from recordings: a part of the compliance, and a noise, which is that of a
/// SmartRock in simulated passages of the inspection train (compliance_of).
struct RecordingErrors {
    double relative = 0.1;
    double noise = 0.3e-9; ///< m/N
};

/// What recordings of these movements would say, with errors drawn from `seed`. Sensor rocks that
/// give way by less than 1e-10 m/N are left out.
std::vector<RecordedMovement> recorded(const PassageMovements& movements,
                                       const RecordingErrors& errors, std::uint64_t seed);

/// Reads a CSV file with the columns `sensor`, the number from 1 in the order of `names`,
/// `compliance_um_per_kN`, above 0 and at most 500, and `deviation_um_per_kN`, at least 0 and at
/// most the compliance; one line for each sensor rock that was recorded. Throws InputError, naming
/// the file with its line, and OutputError.
std::vector<RecordedMovement> read_movements(const std::filesystem::path& file,
                                             const std::vector<std::string>& names);
/// What was judged of the recording of a sensor rock.
struct JudgedRecording {
    std::size_t sensor = 0;            ///< index among those of the slice
    TrainFit fit = {};                 ///< speed 0: it was refused before
    std::string left_out_because = {}; ///< empty: its compliance is used
};
/// One line: how well it fits the train, or why it is left out. `name`: of the sensor rock.
std::string sentence_of(const JudgedRecording& recording, const std::string& name);

/// The compliances of a folder of recordings, and what was judged of all of them.
struct FolderOfMovements {
    std::vector<RecordedMovement> movements;
    std::vector<JudgedRecording> recordings;
};
/// The compliances of the sensor rocks in the last passage of a folder of recordings
/// (read_passages), whose ids are the numbers of `names`; `passing` is the train (compliance_of).
/// Sensors that quality control refuses (check_recordings) or whose recording gives no compliance
/// are left out. Throws InputError, naming --recordings, for other ids and without a recording.
FolderOfMovements movements_in(const std::filesystem::path& folder, const PassingTrain& passing,
                               const std::vector<std::string>& names);
void write_movements(const std::filesystem::path& file,
                     const std::vector<RecordedMovement>& movements,
                     const std::vector<std::string>& names);

} // namespace bris

#pragma once

#include "scenarios/ballast_box/track_slice.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
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
/// The compliances of the sensor rocks in the last passage of a folder of recordings
/// (read_passages), whose ids are the numbers of `names`; `load` is the force of its train on a tie
/// (compliance_of). Sensors that quality control refuses (check_recordings) or whose recording
/// gives no compliance are left out, and `report` is told why. Throws
/// InputError, naming --recordings, if no sensor has one.
std::vector<RecordedMovement>
movements_in(const std::filesystem::path& folder, const LoadHistory& load,
             const std::vector<std::string>& names,
             const std::function<void(const std::string& line)>& report);
void write_movements(const std::filesystem::path& file,
                     const std::vector<RecordedMovement>& movements,
                     const std::vector<std::string>& names);

} // namespace bris

#pragma once

#include "scenarios/ballast_box/track_slice.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace bris {

/// The deflection of a sensor rock in a passage, from its recording.
struct RecordedMovement {
    std::size_t sensor = 0; ///< index among those of the slice
    double deflection = 0;  ///< m, > 0
    double deviation = 0;   ///< m, standard deviation of its error
};

/// Errors of deflections from recordings: a part of the deflection, and a noise of integration,
/// which is that of a SmartRock (deflection_of).
struct RecordingErrors {
    double relative = 0.05;
    double noise = 7e-5; ///< m
};

/// What recordings of these movements would say, with errors drawn from `seed`. Sensor rocks that
/// move less than 1e-5 m are left out.
std::vector<RecordedMovement> recorded(const PassageMovements& movements,
                                       const RecordingErrors& errors, std::uint64_t seed);

/// Reads a CSV file with the columns `sensor`, the number from 1 in the order of `names`,
/// `deflection_mm`, above 0 and at most 50, and `deviation_mm`, at least 0 and at most the
/// deflection; one line for each sensor rock that was recorded. Throws InputError, naming the file
/// with its line, and OutputError.
std::vector<RecordedMovement> read_movements(const std::filesystem::path& file,
                                             const std::vector<std::string>& names);
/// The deflections of the sensor rocks in the last passage of a folder of recordings
/// (read_passages), whose ids are the numbers of `names`; `load` is the force of its train on a tie
/// (deflection_of). Sensors that quality control refuses (check_recordings) or whose recording has
/// no deflection are left out, and `report` is told why. Throws
/// InputError, naming --recordings, if no sensor has one.
std::vector<RecordedMovement>
movements_in(const std::filesystem::path& folder, const LoadHistory& load,
             const std::vector<std::string>& names,
             const std::function<void(const std::string& line)>& report);
void write_movements(const std::filesystem::path& file,
                     const std::vector<RecordedMovement>& movements,
                     const std::vector<std::string>& names);

} // namespace bris

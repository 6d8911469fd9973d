#pragma once

#include "scenarios/ballast_box/track_slice.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// The drawdown of a sensor rock in a passage, from its recording.
struct RecordedMovement {
    std::size_t sensor = 0; ///< index among those of the slice
    double drawdown = 0;    ///< m, > 0
    double deviation = 0;   ///< m, standard deviation of its error
};

/// Errors of drawdowns from recordings: a part of the drawdown and a noise of integration.
struct RecordingErrors {
    double relative = 0.05;
    double noise = 2e-5; ///< m
};

/// What recordings of these movements would say, with errors drawn from `seed`. Sensor rocks that
/// move less than 1e-5 m are left out.
std::vector<RecordedMovement> recorded(const PassageMovements& movements,
                                       const RecordingErrors& errors, std::uint64_t seed);

/// Reads a CSV file with the columns `sensor`, the number from 1 in the order of `names`,
/// `drawdown_mm`, above 0 and at most 50, and `deviation_mm`, at least 0 and at most the drawdown;
/// one line for each sensor rock that was recorded. Throws InputError, naming the file with its
/// line, and OutputError.
std::vector<RecordedMovement> read_movements(const std::filesystem::path& file,
                                             const std::vector<std::string>& names);
void write_movements(const std::filesystem::path& file,
                     const std::vector<RecordedMovement>& movements,
                     const std::vector<std::string>& names);

} // namespace bris

#pragma once

#include "engine/io/csv.hpp"
#include "scenarios/sensors/sensor_info.hpp"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace bris {

struct KnownColumn;

/// Whether a number is a count: a non-negative whole number that a double represents exactly.
inline bool is_count(double n) { return n >= 0 && n < 9e15 && n == std::floor(n); }

/// Recording of one SmartRock, in SI units and in body axes, in order of arrival. A sample without
/// time, force, rate, displacement or attitude has NaN there, which quality control refuses;
/// strain, phase, field, temperature and battery may be sampled less often (NaN). A channel that
/// the file does not have is empty.
struct Recording {
    SensorInfo info;
    std::vector<double> time;            ///< s, by the clock of the sensor
    std::vector<double> strain;          ///< axial, of the test
    std::vector<double> phase;           ///< load cycles since the test began
    std::vector<std::uint64_t> sequence; ///< sample counter
    std::vector<Vec3> force, rate;       ///< specific force, m/s2, and angular rate, rad/s
    std::vector<Vec3> field;             ///< T, of the magnetometer
    std::vector<Vec3> displacement;      ///< m, world frame, by other means than inertia
    std::vector<Quat> attitude;          ///< body to world
    std::vector<double> temperature;     ///< K, of the sensor
    std::vector<double> battery;         ///< V or %, info.battery_unit
    std::vector<std::uint64_t> flags;    ///< see reject_flagged
    std::vector<double> flagged;         ///< s, times of the samples that were left out
    /// By channel: location (file and line) of the first sample, not left out, without a finite
    /// number.
    std::map<std::string, std::string> first_without;
    std::vector<std::string> unused; ///< fields of the file that are no channel, by their names
    std::size_t size() const { return time.size(); }
};

/// Removes samples that the sensor itself flags as unusable: flags other than 0, except for the
/// bits of flags_ignored. Also empties optional channels (strain, phase, field, temperature,
/// battery) without any finite number: this sensor does not have them.
void reject_flagged(Recording& recording);

/// The columns that recordings may have, with the units that a column map may give.
const std::vector<KnownColumn>& recording_columns();

/// Reads the recordings of several SmartRocks from one CSV file with a row for each sample: columns
/// t, id and those of channels (all_channels); others are ignored, whatever they hold. A unit given
/// by `form` replaces that of the metadata. Throws InputError with file:line, also for rows of an
/// id without metadata and for vectors with a missing column.
std::vector<Recording> read_recordings(const std::filesystem::path& csv,
                                       const std::vector<SensorInfo>& sensors,
                                       const CsvForm& form = {});

/// Writes the channels that all recordings have, in order of time, without samples left out, in the
/// units of the metadata and in the axes of the sensors. Throws OutputError.
void write_recordings(const std::filesystem::path& csv, const std::vector<Recording>& recordings,
                      const std::vector<std::string>& comments);

/// Reads and writes the same as one HDF5 file: /sensors/ID/time and the datasets of channels, n or
/// n x components; others are ignored. The metadata are attributes of /sensors/ID; units given
/// there, or as attribute units of a dataset, must be those of `sensors`. Throws InputError for
/// wrong shapes, ids or units, OutputError if the file cannot be read or written.
std::vector<Recording> read_recordings_hdf5(const std::filesystem::path& path,
                                            const std::vector<SensorInfo>& sensors);
std::vector<SensorInfo> read_sensor_infos_hdf5(const std::filesystem::path& path);
void write_recordings_hdf5(const std::filesystem::path& path,
                           const std::vector<Recording>& recordings);

} // namespace bris

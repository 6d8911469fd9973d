#pragma once

#include "engine/io/column_map.hpp"
#include "engine/io/hdf5_content.hpp"
#include "scenarios/sensors/recording.hpp"

#include <set>
#include <string>
#include <vector>

namespace bris {

// What read_sensor_infos_hdf5 and read_recordings_hdf5 find in a file, of one whose group /sensors
// has been read: each reading of a file starts a process.

std::vector<SensorInfo> sensor_infos_in(const Hdf5Content& file);
std::vector<Recording> recordings_in(const Hdf5Content& file,
                                     const std::vector<SensorInfo>& sensors);

/// Throws InputError if a dataset states, by an attribute units or unit, another unit than `unit`,
/// the one of `units` that it is read in.
void require_unit(const Hdf5Content& file, const std::string& dataset, const std::string& unit,
                  const std::vector<ColumnUnit>& units);

/// The members of a group and its attributes (as @name), sorted, that are not among `used`.
std::vector<std::string> unused_in(const Hdf5Content& file, const std::string& group,
                                   const std::set<std::string>& used);

} // namespace bris

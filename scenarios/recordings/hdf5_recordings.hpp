#pragma once

#include "engine/io/hdf5_content.hpp"
#include "scenarios/recordings/bench_hdf5.hpp"
#include "scenarios/recordings/recording.hpp"

#include <vector>

namespace bris {

// What read_sensor_infos_hdf5, read_recordings_hdf5 and read_bench find in a file, of one whose
// groups /sensors and /bench have been read: each reading of a file starts a process.

std::vector<SensorInfo> sensor_infos_in(const Hdf5Content& file);
std::vector<Recording> recordings_in(const Hdf5Content& file,
                                     const std::vector<SensorInfo>& sensors);
Bench bench_in(const Hdf5Content& file, double pressure);

} // namespace bris

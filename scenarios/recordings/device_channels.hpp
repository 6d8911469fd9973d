#pragma once

#include "engine/io/column_map.hpp"
#include "scenarios/recordings/recording.hpp"

#include <string>
#include <vector>

namespace bris {

/// A channel with one number per sample that only the quality control reads, such as the
/// temperature of the sensor. Readers, writers and live streams handle all of them alike.
struct DeviceChannel {
    const char* column;  ///< name in CSV files, streams and findings
    const char* dataset; ///< name in HDF5 files, where the attribute DATASET_unit holds its unit
    std::vector<double> Recording::*values;
    std::string SensorInfo::*unit; ///< unit in the files
    /// Units that a column map may give. Numbers in a unit with scale 1 and offset 0 keep their
    /// unit; all others are converted to the first.
    std::vector<ColumnUnit> units;
    /// Conversion from the unit of the files to that of `values`, and back; null: the same unit.
    double (SensorInfo::*from_file)(double) const = nullptr;
    double (SensorInfo::*to_file)(double) const = nullptr;

    double value_of_file(const SensorInfo& info, double recorded) const {
        return from_file != nullptr ? (info.*from_file)(recorded) : recorded;
    }
    double file_value_of(const SensorInfo& info, double value) const {
        return to_file != nullptr ? (info.*to_file)(value) : value;
    }
};

const std::vector<DeviceChannel>& device_channels();

} // namespace bris

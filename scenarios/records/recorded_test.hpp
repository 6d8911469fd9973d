#pragma once

#include "engine/io/column_map.hpp"
#include "scenarios/records/synchronise.hpp"
#include "scenarios/records/test_curves.hpp"
#include "scenarios/sensors/quality_control.hpp"
#include "scenarios/sensors/sensor_trajectory.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// What is measured of a test: curves (NaN: not measured, or removed by quality control), and the
/// trajectories of the sensor rocks, if any.
struct Measurements {
    MeasuredCurves curves; ///< axial strain, q, volumetric strain and ring radii
    /// Of all sensors; empty if a sensor was refused.
    std::vector<SensorTrajectory> trajectories = {};
    double displacement_noise = 1e-4; ///< m, of the trajectories, root mean square
};

/// A recorded triaxial test at one confining pressure. Its folder contains FOLDER/rock_01.txt ...
/// (metadata of the sensor rocks), FOLDER/55kPa/recordings.csv and FOLDER/55kPa/test.csv
/// (axial_strain, deviatoric_stress_Pa; optional: volumetric_strain, ring_1_radius_m ..., t and
/// phase), or in place of these FOLDER/55kPa/recordings.h5, with or without /bench for test.csv.
struct RecordedTest : Measurements {
    double pressure = 0; ///< Pa
    std::vector<Recording> recordings;
    std::vector<Finding> findings;              ///< of the sensors and of the test machine
    MachineClock clock;                         ///< for sensors that do not record strain
    std::vector<std::string> unused_of_machine; ///< fields of its file that are no measurement
    /// Number of sensors that were refused.
    std::size_t refused() const;
};

/// Settings of the quality control of a recorded test.
struct QualityControlSettings {
    double rest = 60;       ///< s at the beginning during which the rocks are at rest
    double interval = 1e-3; ///< axial strain between samples
    bool displacement = true, attitude = true; ///< whether these channels are used if recorded
    /// Column maps of recordings.csv and test.csv (column_map.hpp); empty: columns.txt and
    /// machine_columns.txt in the folder or, where they are not there, the format of BRIS.
    std::filesystem::path columns = {}, machine_columns = {};
};

/// Runs the quality control of a test: clears the channels that are not to be used, computes the
/// trajectories of the sensors that are accepted, and removes wrong measurements of the machine.
void examine(RecordedTest& test, const QualityControlSettings& settings);

/// The columns that test.csv may have, with the units that a column map may give.
const std::vector<KnownColumn>& machine_columns();

/// Reads the metadata of all sensor rocks, in order of id: from FOLDER/rock_NN.txt, or if there are
/// none, from all FOLDER/*/recordings.h5; for a sensor in several of these the first counts. Throws
/// InputError, OutputError.
std::vector<SensorInfo> read_sensor_infos(const std::filesystem::path& folder);

/// The same for the test at one pressure (Pa): if there are no files rock_NN.txt, the metadata in
/// its own recordings.h5 (with the pose and clock of that test) replace those of `infos`. Throws
/// InputError, OutputError.
std::vector<SensorInfo> infos_of_test(const std::filesystem::path& folder, double pressure,
                                      std::vector<SensorInfo> infos);

/// The question whether 1000 times this pressure (Pa) is meant, if there is a folder for that; "".
std::string hint_at_pressure(double pressure, const std::vector<std::string>& folders);

/// Reads the test at one pressure (Pa) and runs its quality control. `infos`: see infos_of_test.
/// Throws InputError with file:line, also if two files contain the same data; OutputError.
RecordedTest read_recorded_test(const std::filesystem::path& folder, double pressure,
                                const std::vector<SensorInfo>& infos,
                                const QualityControlSettings& settings);

/// Writes the metadata, the recordings and the measurements of the machine. `pressure`: Pa. Throws
/// OutputError.
void write_recorded_test(const std::filesystem::path& folder, double pressure,
                         const std::vector<Recording>& recordings, const MeasuredCurves& measured);

/// The same with one file recordings.h5 in place of the metadata, recordings.csv and test.csv.
/// `time`: s, of each row; `area`: m2, of the specimen at the start.
void write_recorded_test_hdf5(const std::filesystem::path& folder, double pressure,
                              const std::vector<Recording>& recordings,
                              const MeasuredCurves& measured, const std::vector<double>& time,
                              double area);

} // namespace bris

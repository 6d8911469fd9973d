#pragma once

#include "engine/io/column_map.hpp"
#include "scenarios/recordings/quality_control.hpp"
#include "scenarios/recordings/sensor_trajectory.hpp"
#include "scenarios/recordings/synchronise.hpp"
#include "scenarios/recordings/triaxial_point.hpp"
#include "scenarios/specimens/specimen.hpp"

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace bris {

/// A triaxial test at one pressure as a folder of files tells it: FOLDER/rock_01.txt ... of the
/// sensor rocks, FOLDER/55kPa/recordings.csv and FOLDER/55kPa/test.csv (axial_strain,
/// deviatoric_stress_Pa; volumetric_strain, ring_1_radius_m ..., t and phase where measured); or in
/// place of these FOLDER/55kPa/recordings.h5, with or without /bench for test.csv.
struct RecordedTest {
    double pressure = 0; ///< Pa
    std::vector<Recording> recordings;
    std::vector<Finding> findings; ///< of the intake: of sensors, and of the test machine
    std::vector<SensorTrajectory>
        trajectories; ///< of all sensors; one that was refused tells nothing
    std::vector<TriaxialPoint>
        measured; ///< strain, q, volumetric strain and ring radii (NaN: not measured, or left out)
    MachineClock clock; ///< for sensors that do not record strain
    std::size_t refused() const;
};

/// What is taken from recordings.
struct QualityControlSettings {
    double rest = 60;       ///< s, at their beginning, in which the rocks lie still
    double interval = 1e-3; ///< axial strain between samples
    bool displacement = true, attitude = true; ///< whether these channels are used where there are
    std::filesystem::path columns = {},
                          machine_columns = {}; ///< how recordings.csv and test.csv are written
                                                ///< (column_map.hpp); empty: as by this project
};

/// Looks at the recordings of a test, and takes from those that pass how their rocks moved; clears
/// the channels that are not to be used. Looks at what the machine measured, too, and leaves out
/// what is wrong.
void examine(RecordedTest& test, const QualityControlSettings& settings);

/// What was found, or that nothing was: of the test machine, and of each sensor.
std::string quality_control_report(const RecordedTest& test);

/// The columns that test.csv may have, with the units in which a column map may give them.
const std::vector<KnownColumn>& machine_columns();

/// The metadata of all sensor rocks, by id: FOLDER/rock_NN.txt, or where there is none, those in
/// all FOLDER/*/recordings.h5, of a sensor in several of them as in the first. Throws InputError,
/// OutputError.
std::vector<SensorInfo> read_sensor_infos(const std::filesystem::path& folder);

/// The same for the test at one pressure (Pa): without files rock_NN.txt what its own recordings.h5
/// says of a sensor (of its pose and clock by then) stands in place of `infos`. Throws InputError,
/// OutputError.
std::vector<SensorInfo> infos_of_test(const std::filesystem::path& folder, double pressure,
                                      std::vector<SensorInfo> infos);

/// `infos`: see infos_of_test. Throws InputError with file:line, also where one thing is told by
/// two files; OutputError.
RecordedTest read_recorded_test(const std::filesystem::path& folder, double pressure,
                                const std::vector<SensorInfo>& infos,
                                const QualityControlSettings& settings);

/// Writes metadata, recordings, the sensor rocks' given poses (in radii and heights of the
/// specimen) and what was measured. Throws OutputError.
void write_recorded_test(const std::filesystem::path& folder, double pressure,
                         const std::vector<Recording>& recordings, const SpecimenSettings& specimen,
                         const std::vector<SmartRockPose>& poses,
                         const std::vector<TriaxialPoint>& measured);

/// The same with one file recordings.h5 in place of metadata, recordings.csv and test.csv. `time`:
/// s, of what was measured.
void write_recorded_test_hdf5(const std::filesystem::path& folder, double pressure,
                              const std::vector<Recording>& recordings,
                              const SpecimenSettings& specimen,
                              const std::vector<SmartRockPose>& poses,
                              const std::vector<TriaxialPoint>& measured,
                              const std::vector<double>& time);

} // namespace bris

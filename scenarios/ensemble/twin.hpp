#pragma once

#include "scenarios/ensemble/model_run.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace bris {

/// Indices of the rocks of a run that carry its sensors, which are the first ones.
std::vector<std::size_t> sensor_rocks(const ModelRun& run);

/// Faults of recordings: lost samples and outliers.
struct RecordingFaults {
    double dropout = 0, outliers = 0;                           ///< fractions of all samples
    double outlier_displacement = 0.02, outlier_rotation = 0.5; ///< m and rad, of an outlier
};

/// Trajectories that sensors on some rocks of a true run observe, every `interval` of axial strain,
/// with noise (m and rad, standard deviations for each axis).
std::vector<SensorTrajectory> recorded_trajectories(const ModelRun& truth,
                                                    const std::vector<std::size_t>& hosts,
                                                    double interval, double position_noise,
                                                    double attitude_noise, std::uint64_t seed,
                                                    const RecordingFaults& faults = {});

/// Settings of synthetic recordings, as they are written to files, of a test that comes to rest at
/// the end of each stage: what inertial sensors record at rest before the test and then as means
/// over `interval` of axial strain, and displacement and attitude as measured by other means.
struct RecordingSettings {
    double interval = 1e-3;
    double stage_time = 1.2;            ///< s, duration of 0.01 % of strain in a real test
    double rest = 60;                   ///< s, before the test
    std::string imu = "smartrock-like"; ///< a preset
    double displacement_noise = 1e-4, attitude_noise = 2e-3; ///< m and rad
    /// m and rad, uncertainty of the known poses at the start.
    double placement_noise = 3e-3, levelling_noise = 0.03;
};
/// Synthetic recordings of the sensors of a true run. The model of the device omits quantisation,
/// bandwidth and loss of single samples, which do not affect such means (the noise of force is 0.8
/// of a digit and more in all presets), and accelerations with the effect of the lever arm, which
/// average out from one state of rest to the next.
std::vector<Recording> record_sensors(const ModelRun& truth, const RecordingSettings& settings,
                                      std::uint64_t seed);

/// Sensors of a truth. ideal: displacement and attitude almost exactly; tracked: both with the
/// noise of an external measurement; inertial: what an inertial sensor records of itself, after
/// quality control: the tilt by gravity, and nothing else.
enum class SensorMode : std::uint8_t { ideal, tracked, inertial };
const std::vector<std::string>& texts_of(SensorMode);
struct SensorSettings {
    SensorMode mode = SensorMode::tracked;
    std::string imu = "smartrock-like";                  ///< a preset
    double interval = 1e-3;                              ///< axial strain
    double position_noise = 1e-4, attitude_noise = 2e-3; ///< m and rad, of tracked sensors
    RecordingFaults faults = {};                         ///< of tracked and ideal sensors
};

/// Observations of a run by such sensors, and their noise.
struct SensorObservations {
    std::vector<SensorTrajectory> trajectories;
    double position_noise, attitude_noise; ///< m and rad
    std::size_t refused = 0;               ///< sensors that quality control refused
};
SensorObservations observe_sensors(const ModelRun& truth, const SensorSettings& settings,
                                   std::uint64_t seed);

/// Root mean square errors of a run against the truth, over stages (and rocks).
struct TwinErrors {
    double q = 0, volumetric_strain = 0, ring_radius = 0; ///< Pa, -, m
    /// m and rad, by shell: sensor rocks, 1, 2, 3, and 4 and beyond.
    std::vector<double> displacement, rotation;
};
TwinErrors errors_of(const ModelRun& run, const ModelRun& truth);

} // namespace bris

#pragma once

#include "scenarios/assimilation/model_run.hpp"

#include <string>
#include <vector>

namespace bris {

/// The first rocks of a run, which carry its sensors.
std::vector<std::size_t> sensor_rocks(const ModelRun& run);

/// What goes wrong with samples: some never come, some are grossly off.
struct RecordingFaults {
    double dropout = 0, outliers = 0;                           ///< shares of samples
    double outlier_displacement = 0.02, outlier_rotation = 0.5; ///< m and rad, of an outlier
};

/// What sensors on some rocks of a true run record, every `interval` of axial strain, with noise (m
/// and rad).
std::vector<SensorTrajectory> recorded_trajectories(const ModelRun& truth,
                                                    const std::vector<std::size_t>& hosts,
                                                    double interval, double position_noise,
                                                    double attitude_noise, std::uint64_t seed,
                                                    const RecordingFaults& faults = {});

/// The same as files tell it, of a test that comes to rest at the end of each stage: what inertial
/// sensors record of that run, at rest before the test and then as means over `interval` of axial
/// strain, and displacement and attitude as some other means would measure them.
struct RecordingSettings {
    double interval = 1e-3;
    double stage_time = 1.2;            ///< s, that a real test takes for 0.01 % of strain
    double rest = 60;                   ///< s, before the test
    std::string imu = "smartrock-like"; ///< a preset
    double displacement_noise = 1e-4, attitude_noise = 2e-3; ///< m and rad
    double placement_noise = 3e-3,
           levelling_noise = 0.03; ///< m and rad, of what is known of the poses at the start
};
/// Such means see neither digits (noise of force is 0.8 of one and more in all presets) nor the
/// bandwidth nor single samples that are lost, and from one rest to the next accelerations come to
/// nothing, with what a lever arm adds to them: the device is taken without these.
std::vector<Recording> record_sensors(const ModelRun& truth, const RecordingSettings& settings,
                                      std::uint64_t seed);

/// Which sensors a truth has. "ideal": displacement and attitude all but exactly; "tracked": with
/// noise, as another means than inertia would tell them; "honest-imu": what an inertial sensor
/// records of itself, through the intake: tilt by gravity, and nothing else.
inline const std::vector<std::string> sensor_modes{"ideal", "tracked", "honest-imu"};
struct SensorSettings {
    std::string mode = "tracked";
    std::string imu = "smartrock-like";                  ///< a preset
    double interval = 1e-3;                              ///< axial strain
    double position_noise = 1e-4, attitude_noise = 2e-3; ///< m and rad, of those that are tracked
    RecordingFaults faults = {};                         ///< likewise
};

/// What such sensors tell of a run, and how well.
struct SensorObservations {
    std::vector<SensorTrajectory> trajectories;
    double position_noise, attitude_noise; ///< m and rad
    std::size_t refused = 0;               ///< sensors, at the intake
};
SensorObservations observe_sensors(const ModelRun& truth, const SensorSettings& settings,
                                   std::uint64_t seed);

/// Root mean square errors against the truth, over stages (and rocks).
struct TwinErrors {
    double q = 0, volumetric_strain = 0, ring_radius = 0; ///< Pa, -, m
    std::vector<double> displacement,
        rotation; ///< m and rad, by shell: sensors, 1, 2, 3, 4 and beyond
};
TwinErrors errors_of(const ModelRun& run, const ModelRun& truth);

/// How far the smoothed ways of sensor rocks are off the truth, root mean square over all sensors
/// and times.
struct SmoothedErrors {
    double displacement, rotation; ///< m and rad
    double squared_distance; ///< of positions, in their deviations, for each axis: 1 if these are
                             ///< honest
};
SmoothedErrors errors_of_smoothed(const ModelRun& run, const ModelRun& truth);

} // namespace bris

#pragma once

#include "scenarios/ensemble/analysis.hpp"

#include <filesystem>

namespace bris {

/// Sensor layouts to compare: sensors on different rocks of a run, in different numbers, with
/// different sampling intervals.
struct LayoutTrial {
    std::vector<std::size_t> sensors{3, 10, 30, 100};
    std::vector<double> intervals{1e-4, 1e-3, 5e-3};     ///< axial strain between samples
    unsigned draws = 10;                                 ///< number of random layouts
    double position_noise = 1e-4, attitude_noise = 2e-3; ///< m and rad, of the recordings
    std::uint64_t seed = 1;
};

/// Ratios of the analysis error to the forecast error, each the root mean square over all stages;
/// geometric means over the draws.
struct LayoutResult {
    /// placed: the sensor rocks of the run itself; random; informed: the rocks whose observation
    /// reduces the forecast variance of all rocks most.
    std::string layout;
    std::size_t sensors;
    double interval;
    double hosts_error_ratio; ///< displacement of the rocks with sensors
    /// Displacement of the rocks without a sensor whose centre is as near to one with a sensor as
    /// that of a touching rock.
    double near_error_ratio;
    double others_error_ratio;        ///< displacement of all rocks without a sensor
    double near_rotation_error_ratio; ///< rotation of the near rocks
    double seconds_per_stage;         ///< s, wall time of the analysis of a stage
};

/// Chooses `count` rocks one after the other, each as the one whose observation, with `noise` as
/// its standard deviation, leaves the least variance over all rocks at the last stage.
std::vector<std::size_t> most_informative_rocks(const std::vector<RockPose>& rocks,
                                                const MotionScatter& scatter, double noise,
                                                std::size_t count);

/// Analyses a forecast with each layout of the trial, and compares it with the truth.
std::vector<LayoutResult> try_layouts(const ModelRun& truth, const ModelRun& forecast,
                                      const RockScatter& scatter, const LayoutTrial& trial);

/// Writes the results as a CSV file. Throws OutputError.
void write_layouts(const std::filesystem::path& path, const std::vector<LayoutResult>& results);

} // namespace bris

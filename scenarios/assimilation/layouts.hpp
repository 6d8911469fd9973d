#pragma once

#include "scenarios/assimilation/analysis.hpp"

#include <filesystem>

namespace bris {

/// What to try: sensors on other rocks of a run, in other numbers, telling more or less often.
struct LayoutTrial {
    std::vector<std::size_t> sensors{3, 10, 30, 100};
    std::vector<double> intervals{1e-4, 1e-3, 5e-3};     ///< of axial strain, between samples
    unsigned draws = 10;                                 ///< of random layouts
    double position_noise = 1e-4, attitude_noise = 2e-3; ///< m and rad, of the recordings
    std::uint64_t seed = 1;
};

/// Shares of the forecast's root mean square error, over all stages, that are left; geometric means
/// over the draws.
struct LayoutResult {
    std::string layout; ///< placed: the run's own sensor rocks; random; informed: those that tell
                        ///< most of all rocks
    std::size_t sensors;
    double interval;
    double hosts_error_ratio;  ///< displacement of the rocks with sensors
    double near_error_ratio;   ///< of those without whose centre is as near to a sensor's as rocks
                               ///< that touch
    double others_error_ratio; ///< of all without
    double near_rotation_error_ratio; ///< rotation of those near
    double seconds_per_stage;         ///< that the analysis of a stage takes
};

/// One after the other, the rocks whose motion, once measured with a noise (a deviation), leaves
/// least variance over all rocks at the end.
std::vector<std::size_t> most_informative_rocks(const std::vector<RockPose>& rocks,
                                                const MotionScatter& scatter, double noise,
                                                std::size_t count);

std::vector<LayoutResult> try_layouts(const ModelRun& truth, const ModelRun& forecast,
                                      const RockScatter& scatter, const LayoutTrial& trial);

/// As a table on the terminal and in a CSV file.
void write_layouts(const std::filesystem::path& path, const std::vector<LayoutResult>& results);

} // namespace bris

#pragma once

#include "engine/archive.hpp"

#include <filesystem>
#include <limits>
#include <vector>

namespace bris {

/// Record of one analysis of a sensor: innovations of position and attitude, their gains, and the
/// correction that was applied. NaN: not measured.
struct AnalysisRecord {
    static constexpr double none = std::numeric_limits<double>::quiet_NaN();
    double time = 0;                                               ///< s, or axial strain
    double sensor = 0;                                             ///< row of the sensor, from 0
    double position_innovation = none, attitude_innovation = none; ///< m and rad, magnitudes
    /// Chi-squared with three degrees of freedom.
    double position_normalised_innovation_squared = none,
           attitude_normalised_innovation_squared = none;
    double position_gain = none, attitude_gain = none; ///< mean of the three axes; 0: rejected
    /// m and rad: standard deviation per axis after the analysis.
    double position_deviation = none, attitude_deviation = none;
    double share = 1; ///< fraction of the correction that was applied
    double work = 0;  ///< J, work of all earlier corrections on this rock

    static void visit(auto& self, auto&& visit_one) {
        visit_one("time", self.time);
        visit_one("sensor", self.sensor);
        visit_one("position_innovation_m", self.position_innovation);
        visit_one("attitude_innovation_rad", self.attitude_innovation);
        visit_one("position_normalised_innovation_squared",
                  self.position_normalised_innovation_squared);
        visit_one("attitude_normalised_innovation_squared",
                  self.attitude_normalised_innovation_squared);
        visit_one("position_gain", self.position_gain);
        visit_one("attitude_gain", self.attitude_gain);
        visit_one("position_deviation_m", self.position_deviation);
        visit_one("attitude_deviation_rad", self.attitude_deviation);
        visit_one("share_given", self.share);
        visit_one("work_before_J", self.work);
    }
};

void save_records(Archive& archive, const std::string& path,
                  const std::vector<AnalysisRecord>& records);
std::vector<AnalysisRecord> load_records(const Archive& archive, const std::string& path);

/// Writes the records as CSV, one line each. `time`: name of the time column. Throws OutputError.
void write_records(const std::filesystem::path& csv, const std::vector<AnalysisRecord>& records,
                   const std::string& time);

} // namespace bris

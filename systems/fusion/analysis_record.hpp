#pragma once

#include "engine/archive.hpp"

#include <filesystem>
#include <limits>
#include <vector>

namespace bris {

/// One analysis of a sensor: how far its rock was from where it was expected, what weight that got,
/// and what came of it. Of place and attitude; NaN: not measured.
struct AnalysisRecord {
    static constexpr double none = std::numeric_limits<double>::quiet_NaN();
    double time = 0;                                               ///< s, or axial strain
    double sensor = 0;                                             ///< its row, from 0
    double position_innovation = none, attitude_innovation = none; ///< innovations, m and rad
    double position_normalised_innovation_squared = none,
           attitude_normalised_innovation_squared =
               none; ///< squared, of these: chi square of three degrees
    double position_gain = none, attitude_gain = none; ///< mean of the three axes; 0: refused
    double position_deviation = none,
           attitude_deviation = none; ///< after it, of an axis: m and rad
    double share = 1;                 ///< of the correction, that was given
    double work = 0;                  ///< J, that corrections had put into this rock before it
    double work_allowed = none,
           work_expected = none; ///< J, of all rocks together until the next one, and of
                                 ///< corrections given whole (WorkBudget); NaN: no limit

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
        visit_one("work_allowed_J", self.work_allowed);
        visit_one("work_expected_J", self.work_expected);
    }
};

void save_records(Archive& archive, const std::string& path,
                  const std::vector<AnalysisRecord>& records);
std::vector<AnalysisRecord> load_records(const Archive& archive, const std::string& path);

/// Writes them, a line for each; `time`: what it is. Throws OutputError.
void write_records(const std::filesystem::path& csv, const std::vector<AnalysisRecord>& records,
                   const std::string& time);

} // namespace bris

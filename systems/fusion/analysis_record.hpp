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
    double time = 0;                          ///< s, or axial strain
    double sensor = 0;                        ///< its row, from 0
    double shift_off = none, turn_off = none; ///< innovations, m and rad
    double shift_distance = none,
           turn_distance = none;                ///< squared, of these: chi square of three degrees
    double shift_gain = none, turn_gain = none; ///< mean of the three axes; 0: refused
    double shift_deviation = none, turn_deviation = none; ///< after it, of an axis: m and rad
    double share = 1;                                     ///< of the correction, that was given
    double work = 0; ///< J, that corrections had put into this rock before it
    double work_allowed = none,
           work_expected = none; ///< J, of all rocks together until the next one, and of
                                 ///< corrections given whole (WorkAccount); NaN: no limit

    static void visit(auto& self, auto&& visit_one) {
        visit_one("time", self.time);
        visit_one("sensor", self.sensor);
        visit_one("shift_off_m", self.shift_off);
        visit_one("turn_off_rad", self.turn_off);
        visit_one("shift_squared_distance", self.shift_distance);
        visit_one("turn_squared_distance", self.turn_distance);
        visit_one("shift_gain", self.shift_gain);
        visit_one("turn_gain", self.turn_gain);
        visit_one("shift_deviation_m", self.shift_deviation);
        visit_one("turn_deviation_rad", self.turn_deviation);
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

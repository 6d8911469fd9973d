#pragma once

#include "engine/estimation/predictive.hpp"
#include "scenarios/ballast_box/track_slice.hpp"
#include "scenarios/forecast/recorded_movements.hpp"

#include <optional>
#include <string>
#include <vector>

namespace bris {

/// Movements of a member of an ensemble in the passage that was recorded on the site, and in the
/// passage of the next train.
struct MemberMovements {
    PassageMovements last, next;
};

/// Deflection of a sensor rock under the next train. The distribution is that of its logarithm.
struct DeflectionForecast {
    Predictive logarithm = {};
    Predictive members = {}; ///< the same without any recording
    std::optional<RecordedMovement> recorded = {};
    double probability_above(double deflection) const; ///< m
    double quantile(double probability) const;         ///< m
};

/// The forecast of a passage.
struct PassageForecast {
    std::vector<DeflectionForecast> rocks; ///< in the order of BoxBodies::sensors
    /// m, of the tie: as the members have it. A SmartRock cannot record a settlement.
    Predictive settlement;
};

/// Forecasts the next passage on a site from the recordings of the last one. The logarithm of the
/// next deflection of each sensor rock is regressed on that of its last compliance over the members
/// (predict_by_line); a rock without recording has the distribution of the members
/// (predict_by_mean). Deflections below 1e-5 m and compliances below 1e-10 m/N count as these.
/// Throws InputError for fewer than 4 members.
PassageForecast forecast_passage(const std::vector<MemberMovements>& members,
                                 const std::vector<RecordedMovement>& recorded);

/// The next deflection (m) of a rock in each member, and its forecast from all other members.
struct LeftOutMember {
    double found;
    DeflectionForecast forecast;
};
/// Each member in turn is the site, with recordings without error, whose deviation is taken as
/// `relative` of the compliance.
std::vector<LeftOutMember> forecasts_of_members(const std::vector<MemberMovements>& members,
                                                std::size_t rock, double relative);

} // namespace bris

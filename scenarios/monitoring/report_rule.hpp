#pragma once

#include "engine/signal/autoregression.hpp"
#include "engine/signal/control_chart.hpp"

#include <array>
#include <limits>
#include <string_view>
#include <vector>

namespace bris {

/// The published readings of "autoregressive model with X-bar chart", the rule of the SmartRock
/// report: charts of the residuals of the baseline's model (Fugate, Sohn and Farrar 2001, Mech.
/// Syst. Signal Process. 15:707), or of the coefficients of models of short windows (Sohn,
/// Czarnecki and Farrar 2000, J. Struct. Eng. 126:1356), to which the level is nothing. Residuals
/// also of the standardised vibration: less its mean, over its standard deviation in the passage.
inline constexpr std::array<std::string_view, 3> readings{"residuals", "standardised_residuals",
                                                          "coefficients"};

struct ReportRuleSettings {
    unsigned subgroup = 20;   ///< residuals in a point, and tenth of the samples of a window
    double width = 3;         ///< of the limits, standard deviations
    double alarm_share = 0.2; ///< of points outside the limits
};

/// The points of the charts of residuals: means and logarithms of deviations of subgroups, in
/// standard deviations of the baseline.
struct ChartPoints {
    std::vector<double> means, deviations;
    std::vector<double> times; ///< s, middle of each subgroup, if the beginnings are given
    double outlier_share(double width) const; ///< NaN without points
};

/// The charts of one sensor's baseline.
class ReportRule {
public:
    ReportRule() = default;
    /// `model`: of the runs, in groups of one passage. Throws InputError if they do not vary.
    ReportRule(const ArModel& model, const std::vector<std::vector<std::vector<double>>>& passages,
               const ReportRuleSettings& settings);
    /// Shares of points outside the limits, in the order of `readings`; NaN: no points.
    std::array<double, readings.size()> outlier_shares(Runs runs) const;
    /// `begins`: s, of the runs, or none.
    ChartPoints points(Runs runs, double rate, const std::vector<double>& begins) const;

private:
    struct Residuals {
        ArModel model;
        ControlChart means, deviations; // of subgroups; logarithms of deviations
    };
    struct Coefficients {
        std::vector<double> means, deviations;
    };
    std::vector<std::vector<double>> window_coefficients(Runs runs) const;
    ChartPoints points(const Residuals& charts, Runs runs) const;
    double outlier_share(const Coefficients& charts, Runs runs) const;

    ReportRuleSettings settings_;
    Residuals plain_, standardised_;
    Coefficients coefficients_;
};

} // namespace bris

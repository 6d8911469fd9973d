#pragma once

#include "engine/options.hpp"
#include "engine/signal/autoregression.hpp"
#include "engine/signal/control_chart.hpp"
#include "engine/signal/roll_pitch_yaw.hpp"
#include "engine/signal/spectrum.hpp"
#include "scenarios/monitoring/passage.hpp"
#include "scenarios/monitoring/vibration.hpp"
#include "scenarios/sensors/quality_control.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// Settings of the comparison of recordings with a baseline.
struct MonitorSettings {
    VibrationQuantity quantity = VibrationQuantity::vertical;
    double rest = 1;          ///< s at the beginning during which the rocks are at rest
    unsigned subgroup = 20;   ///< samples in a point of the charts
    double width = 3;         ///< of the limits, standard deviations
    double alarm_share = 0.2; ///< of points outside the limits
    unsigned largest_order = 30;
    OrderCriterion criterion = OrderCriterion::bic;
    ArMethod method = ArMethod::burg;
    double ewma_weight = 0.1, ewma_width = 2.814;
    double cusum_allowance = 0.5, cusum_limit = 5;
    double least_duration = 2;     ///< s of samples without gaps in the charts
    double largest_missing = 0.05; ///< share of samples
    double largest_saturated = 1e-3;
    double train_level = 0.2;            ///< of the baseline's root mean square: a train passes
    unsigned segment = 256;              ///< samples, of a spectrum
    double band_low = 1, band_high = 80; ///< Hz
    void declare_options(auto& option);
};

/// Hashes of the first 1, 2, 4 ... samples of a recording, which tell it from others without it.
struct Beginnings {
    std::vector<std::uint64_t> force, rate;
    explicit Beginnings(const Recording& recording);
    /// Whether the forces or the rates of two recordings are the same to the last bit over at least
    /// half of their common length.
    bool are_those_of(const Beginnings& other) const;
};

/// What a sensor records where the ballast is known to be good.
struct SensorBaseline {
    unsigned id = 0;
    std::string impossible_because; ///< why it is none; empty: it is one
    double rate = 0;                ///< Hz
    std::size_t samples = 0, passages = 0;
    double train_threshold = 0; ///< m/s2, or rad/s, root mean square while a train passes
    double rms = 0;             ///< of the time while trains pass
    ArModel model;
    OrderChoice orders;
    ControlChart means, deviations; ///< of subgroups of residuals; logarithms of deviations
    double outlier_share = 0;       ///< of its own points
    Spectrum spectrum;
    RollPitchYaw rotation;            ///< rad, root mean squares
    double rate_per_force = 0;        ///< rad/s per m/s2, median; see vibration.hpp
    std::vector<Beginnings> recorded; ///< to find out if one of them is monitored
};

/// The baselines of all sensors in the passages, in order of their ids. Passages of a sensor that
/// quality control refuses, or that have too few samples, are left out; a sensor with none left has
/// no baseline, with the reason.
std::vector<SensorBaseline> baselines_of(const std::vector<Passage>& passages,
                                         const MonitorSettings& settings);
/// The same of the passages in a folder, as read_passages reads them, but with one in memory at a
/// time.
std::vector<SensorBaseline> read_baselines(const std::filesystem::path& folder,
                                           const std::filesystem::path& columns,
                                           const std::string& option,
                                           const MonitorSettings& settings);

/// The points of the charts of some runs: means and logarithms of deviations of subgroups of
/// residuals, in standard deviations of the baseline.
struct ChartPoints {
    std::vector<double> means, deviations;
    std::vector<double> times; ///< s, middle of each subgroup, if the beginnings are given
    double outlier_share(double width) const; ///< NaN without points
};
ChartPoints chart_points(const SensorBaseline& baseline, Runs runs,
                         const std::vector<double>& begins, const MonitorSettings& settings);

/// Quality control of one passage: the findings of all its sensors.
std::vector<Finding> findings_of(const Passage& passage, const MonitorSettings& settings);
/// The refusals of a sensor among them, as one text; empty: it is accepted.
std::string refusal_of(const std::vector<Finding>& findings, unsigned sensor);

void MonitorSettings::declare_options(auto& option) {
    option("quantity", quantity, "",
           "Quantity that is compared: vertical acceleration, or the angular rate about the track "
           "(roll), the tie (pitch) or the vertical (yaw).");
    option("rest", rest, "s",
           "Time at the beginning of each recording during which the rocks are at rest. Windows of "
           "a stream are taken as a whole instead.",
           above(0, 1e6));
    option("subgroup", subgroup, "", "Samples in a point of the control charts.", within(2, 10000));
    option("width", width, "", "Distance of the limits from the centre in standard deviations.",
           above(0, 100));
    option("alarm_share", alarm_share, "",
           "Share of points outside the limits above which a sensor has changed.", within(0, 1));
    option("largest_order", largest_order, "",
           "Largest order of the autoregressive model of the baseline.", within(1, 200));
    option("criterion", criterion, "", "Criterion by which the order is chosen.");
    option("method", method, "", "Method by which the model is estimated.");
    option("ewma_weight", ewma_weight, "", "Weight of a point in the moving average.", above(0, 1));
    option("ewma_width", ewma_width, "", "Width of the limits of the moving average.",
           above(0, 100));
    option("cusum_allowance", cusum_allowance, "", "Allowance of the cumulative sums.",
           within(0, 100));
    option("cusum_limit", cusum_limit, "", "Limit of the cumulative sums.", above(0, 1e6));
    option(
        "least_duration", least_duration, "s",
        "Time without gaps, while a train passes, that a recording must have; with less there is "
        "no verdict.",
        above(0, 1e6));
    option("largest_missing", largest_missing, "",
           "Share of missing samples above which there is no verdict.", within(0, 1));
    option("largest_saturated", largest_saturated, "",
           "Share of samples at the end of the range above which there is no verdict.",
           within(0, 1));
    option("train_level", train_level, "",
           "Root mean square over 0.25 s, relative to that of the whole baseline, above which a "
           "train is passing. Only the time from the first to the last such window is compared.",
           within(0, 1));
    option("segment", segment, "",
           "Samples in a segment of a spectrum, a number without other prime factors than 2, 3 and "
           "5.",
           within(8, 1 << 20));
    option("band_low", band_low, "Hz", "Lower end of the band of the power.", within(0, 1e6));
    option("band_high", band_high, "Hz", "Upper end of the band of the power.", above(0, 1e6));
}

} // namespace bris

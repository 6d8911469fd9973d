#pragma once

#include "engine/options.hpp"
#include "engine/signal/autoregression.hpp"
#include "engine/signal/spectrum.hpp"
#include "scenarios/monitoring/passage.hpp"
#include "scenarios/monitoring/report_rule.hpp"
#include "scenarios/monitoring/site_model.hpp"
#include "scenarios/monitoring/vibration.hpp"
#include "scenarios/sensors/quality_control.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace bris {

/// Settings of the comparison of recordings with a baseline.
struct MonitorSettings {
    /// Largest probability that any sensor of a passage without a change, or all passages of a run
    /// together, raises an alarm.
    double false_alarms = 0.02;
    VibrationQuantity quantity = VibrationQuantity::vertical;
    double rest = 1;          ///< s at the beginning during which the rocks are at rest
    bool every_one = false;   ///< every recording holds a train, as a whole
    double train_level = 0.2; ///< of the baseline's root mean square: a train passes
    unsigned largest_order = 30;
    OrderCriterion criterion = OrderCriterion::bic;
    ArMethod method = ArMethod::burg;
    ReportRuleSettings report_rule;
    double least_duration = 2;     ///< s of samples without gaps that are compared
    double largest_missing = 0.05; ///< share of samples
    double largest_saturated = 1e-3;
    unsigned segment = 256; ///< samples, of a spectrum that is drawn
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
    std::size_t samples = 0;        ///< that are compared
    std::size_t left_out = 0;       ///< passages
    std::string left_out_because;   ///< the first of them
    double train_threshold = 0;     ///< m/s2, or rad/s, root mean square while a train passes
    double rms = 0;                 ///< of the time while trains pass
    ArModel model;
    OrderChoice orders;
    SensorModel features; ///< what is expected of those of a passage
    ReportRule report_rule;
    Spectrum spectrum;                ///< without segments: not computed
    double rate_per_force = 0;        ///< rad/s per m/s2, median; see vibration.hpp
    Vec3 up = Vec3::Zero();           ///< by gravity, body axes; zero: not known
    double tilt_scatter = 0;          ///< rad, root mean square between passages
    double usual_samples() const;     ///< that are compared of a passage
    std::vector<Beginnings> recorded; ///< to find out if one of them is monitored
};

/// The baselines of all sensors in the passages, in order of their ids. Passages of a sensor that
/// quality control refuses, or that have too few samples, are left out; a sensor with none left has
/// no baseline, with the reason.
std::vector<SensorBaseline> baselines_of(const std::vector<Passage>& passages,
                                         const MonitorSettings& settings);
/// The same of passages that are given one after the other to what it passes to `for_each`.
std::vector<SensorBaseline>
read_baselines(const std::function<void(const std::function<void(Passage&&)>&)>& for_each,
               const MonitorSettings& settings);

/// The specific force's mean direction (body axes), which is the vertical; zero: none.
Vec3 up_of(const Recording& recording);

/// s at the beginning of recordings whose mean is the vertical.
double rest_of(const MonitorSettings& settings);
/// Quality control of one passage: the findings of all its sensors.
std::vector<Finding> findings_of(const Passage& passage, const MonitorSettings& settings);
/// The refusals of a sensor among them, as one text; empty: it is accepted.
std::string refusal_of(const std::vector<Finding>& findings, unsigned sensor);

void MonitorSettings::declare_options(auto& option) {
    option("false_alarms", false_alarms, "",
           "Largest probability of an alarm in a passage in which nothing has changed, of all "
           "sensors and features together; and of one in a run, of all its passages.",
           within(1e-6, 0.5));
    option("quantity", quantity, "",
           "Quantity whose level and model are compared: vertical acceleration, or, of sensors "
           "without it, the angular rate about the track (roll), the tie (pitch) or the vertical "
           "(yaw).");
    option("rest", rest, "s",
           "Time at the beginning of each recording during which the rocks are at rest. Windows of "
           "a stream are taken as a whole instead.",
           above(0, 1e6));
    option("every_recording_holds_a_train", every_one, "",
           "Compare recordings as a whole: each holds a train from beginning to end.");
    option("train_level", train_level, "",
           "Root mean square over 0.25 s above which a train is passing, relative to that of the "
           "baseline and to that of the loudest tenth of the passage itself. Only such windows are "
           "compared.",
           within(0, 1));
    option("largest_order", largest_order, "",
           "Largest order of the autoregressive model of the baseline.", within(3, 200));
    option("criterion", criterion, "", "Criterion by which the order is chosen.");
    option("method", method, "", "Method by which the model is estimated.");
    option("least_duration", least_duration, "s",
           "Time without gaps, while a train passes, that a recording must have; with less there "
           "is no verdict.",
           above(0, 1e6));
    option("largest_missing", largest_missing, "",
           "Share of missing samples above which there is no verdict.", within(0, 1));
    option("largest_saturated", largest_saturated, "",
           "Share of samples at the end of the range above which there is no verdict.",
           within(0, 1));
    option("segment", segment, "",
           "Samples in a segment of a spectrum, a number without other prime factors than 2, 3 and "
           "5.",
           within(8, 1 << 20));
    option.group("Control charts of the SmartRock report, beside the verdict");
    option("subgroup", report_rule.subgroup, "", "Samples in a point of the charts.",
           within(2, 10000));
    option("width", report_rule.width, "",
           "Distance of the limits from the centre in standard deviations.", above(0, 100));
    option("alarm_share", report_rule.alarm_share, "",
           "Share of points outside the limits above which the charts call a sensor changed.",
           within(0, 1));
}

} // namespace bris

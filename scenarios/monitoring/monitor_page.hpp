#pragma once

#include "engine/choice.hpp"
#include "engine/io/plot.hpp"
#include "engine/report.hpp"
#include "engine/scenario.hpp"
#include "scenarios/monitoring/passage_stream.hpp"
#include "scenarios/monitoring/site_verdict.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// Everything that a report of the monitor is made of.
struct MonitorReport {
    std::string recordings, baseline; ///< what was compared, for the reader
    const MonitorSettings& settings;
    const std::vector<SensorBaseline>& baselines;
    const std::vector<PassageResult>& passages; ///< that are kept (PassageLog)
    const std::vector<SensorSummary> sensors;   ///< judge_together of these passages
    const PassageTally& tally;                  ///< of all passages
    std::string stream = {};                    ///< report on the stream; empty: a folder was read
    std::optional<StreamCounts> records = {};   ///< of the stream
    std::string notes = {};                     ///< how files of loggers were read
};

/// The overall verdict, at most as good as what was judged: not an all-clear if more than
/// `largest_missing` of the records that were received could not be used.
OverallVerdict overall_verdict(const MonitorReport& report);
/// What was not judged, for --require all; empty: everything was.
std::string not_judged(const MonitorReport& report);

/// Spectrum of the baseline, and of the recording with its 95 % confidence band.
Plot spectrum_plot(const SensorResult& result, const SensorBaseline& baseline,
                   VibrationQuantity quantity);
/// Points of the charts over time, with their limits.
Plot chart_plot(const SensorResult& result, double width);

/// Writes one self-contained page, monitor.html. Throws OutputError.
void write_page(const Common& common, const MonitorReport& report);
/// Draws spectra.png and charts.png, a panel for the most serious result of each sensor, and
/// history.png, their levels.
void draw_pictures(const std::filesystem::path& folder, const MonitorReport& report);
/// Adds the verdicts and numbers: overall, and sensor_ID_... of each.
void add_results(Report& summary, const MonitorReport& report);

} // namespace bris

#include "scenarios/monitoring/monitor_page.hpp"

#include "engine/io/html_page.hpp"
#include "engine/report.hpp"
#include "scenarios/monitoring/passage_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace bris {

namespace {

std::string kind_of(Verdict verdict) {
    return verdict == Verdict::changed       ? "bad"
           : verdict == Verdict::as_baseline ? "good"
                                             : "unknown";
}

std::string number(double x, const char* form = "{:.2f}") {
    return std::isfinite(x) ? fmt::format(fmt::runtime(form), x) : "-";
}

std::string per_cent(double share) {
    return std::isfinite(share) ? fmt::format("{:.1f} %", 100 * share) : "-";
}

const SensorBaseline* baseline_of(const MonitorReport& report, unsigned id) {
    const auto found = std::ranges::find(report.baselines, id, &SensorBaseline::id);
    return found == report.baselines.end() ? nullptr : &*found;
}

std::vector<unsigned> sensors_of(const MonitorReport& report) {
    std::set<unsigned> ids;
    for (const PassageResult& passage : report.passages)
        for (const SensorResult& s : passage.sensors) ids.insert(s.id);
    return {ids.begin(), ids.end()};
}

/// The ratio of band powers with the interval of its spectra: by the F distribution of the degrees
/// of freedom of the band's bins, approximated by a normal distribution of its logarithm.
struct RatioInterval {
    double low = SensorResult::unknown, high = SensorResult::unknown;
};
RatioInterval power_interval(const SensorResult& s, const SensorBaseline& b,
                             const MonitorSettings& settings) {
    if (s.spectrum.segments == 0 || !(s.power_ratio > 0)) return {};
    // a sum of independent bins with unequal densities: nu = nu_bin (sum S)^2 / sum S^2
    const auto freedom = [&](const Spectrum& spectrum) {
        double sum = 0, squares = 0;
        for (std::size_t k = 0; k < spectrum.density.size(); ++k)
            if (spectrum.frequency(k) >= settings.band_low &&
                spectrum.frequency(k) <= settings.band_high) {
                sum += spectrum.density[k];
                squares += spectrum.density[k] * spectrum.density[k];
            }
        return spectrum.degrees_of_freedom * sum * sum / squares * spectrum.spacing /
               spectrum.bandwidth;
    };
    const double deviation = std::sqrt(2 / freedom(s.spectrum) + 2 / freedom(b.spectrum));
    return {s.power_ratio * std::exp(-1.96 * deviation),
            s.power_ratio * std::exp(1.96 * deviation)};
}

/// What the chosen quantity is called and measured in.
struct Named {
    std::string name, density;
};
Named name_of(VibrationQuantity quantity) {
    if (quantity == VibrationQuantity::vertical) return {"vertical acceleration", "(m/s2)2/Hz"};
    const std::string& text = text_of(quantity);
    return {text.substr(0, text.find('_')) + " rate", "(rad/s)2/Hz"};
}

void add_sensor_table(HtmlPage& page, const MonitorReport& report) {
    std::vector<std::vector<std::string>> rows{{"sensor", "verdict", "points outside",
                                                "root mean square", "band power (95 %)",
                                                "roll, pitch, yaw", "spectral entropy", "reason"}};
    std::vector<std::string> kinds;
    for (const unsigned id : sensors_of(report)) {
        const OverallVerdict v = overall_verdict(report.passages, id);
        const SensorResult& s = *most_serious_result(report.passages, id).sensor;
        const SensorBaseline* b = baseline_of(report, id);
        const RatioInterval i = b ? power_interval(s, *b, report.settings) : RatioInterval{};
        rows.push_back(
            {fmt::format("{}", id), text_of(v.verdict), per_cent(s.outlier_share),
             number(s.level_ratio),
             number(s.power_ratio) +
                 (std::isfinite(i.low) ? fmt::format(" ({:.2f}-{:.2f})", i.low, i.high) : ""),
             fmt::format("{}, {}, {}", number(s.rotation_ratio.roll),
                         number(s.rotation_ratio.pitch), number(s.rotation_ratio.yaw)),
             number(s.entropy), v.reason});
        kinds.push_back(kind_of(v.verdict));
    }
    page.table(rows, kinds);
    page.paragraph("Root mean square, band power and rotations are ratios to the baseline. The "
                   "interval of the band power is that of the two spectra; passages scatter more.");
}

void add_history(HtmlPage& page, const MonitorReport& report) {
    if (report.tally.all() < 2) return;
    page.heading("Passages");
    std::vector<std::vector<std::string>> rows{{"passage", "verdict", "reason"}};
    std::vector<std::string> kinds;
    constexpr std::size_t shown = PassageLog::most_last;
    const std::size_t first = report.passages.size() > shown ? report.passages.size() - shown : 0;
    for (std::size_t k = first; k < report.passages.size(); ++k) {
        const OverallVerdict v = overall_verdict({report.passages[k]});
        const bool idle = std::ranges::all_of(report.passages[k].sensors, [](const auto& s) {
            return s.verdict == Verdict::no_train;
        });
        rows.push_back({report.passages[k].name,
                        idle ? text_of(Verdict::no_train) : text_of(v.verdict), v.reason});
        kinds.push_back(kind_of(v.verdict));
    }
    page.table(rows, kinds);
    if (report.tally.all() > shown)
        page.paragraph(
            fmt::format("The first {} passages are in history.csv.", report.tally.all() - shown));
}

std::vector<double> times_since_first(const ChartPoints& points) {
    std::vector<double> times;
    for (const double t : points.times) times.push_back(t - points.times.front());
    return times;
}

/// The moving average, and the cumulative sums, of the standardised level.
std::vector<Plot> level_plots(const SensorResult& result, const MonitorSettings& settings) {
    const std::vector<double> times = times_since_first(result.points);
    Ewma average(settings.ewma_weight, settings.ewma_width);
    Cusum sums(settings.cusum_allowance, settings.cusum_limit);
    Curve ewma{"moving average", times, {}}, above{"above", times, {}}, below{"below", times, {}};
    for (const double z : result.points.deviations) {
        (void)average.add(z);
        (void)sums.add(z);
        ewma.y.push_back(average.value());
        above.y.push_back(sums.above());
        below.y.push_back(-sums.below());
    }
    const auto plot = [&](const char* title, std::vector<Curve> curves, double limit) {
        for (const double sign : {1.0, -1.0})
            curves.push_back({sign > 0 ? "limits" : "",
                              {0, times.back()},
                              {sign * limit, sign * limit},
                              Curve::Style::dashed});
        return Plot{.title = title,
                    .x_label = "time since the train came (s)",
                    .y_label = "standard deviations",
                    .curves = std::move(curves)};
    };
    return {plot("Moving average of the level", {ewma}, average.limit()),
            plot("Cumulative sums of the level", {above, below}, settings.cusum_limit)};
}

void add_sensor(HtmlPage& page, const MonitorReport& report, unsigned id) {
    const MostSerious worst = most_serious_result(report.passages, id);
    const SensorResult& s = *worst.sensor;
    const SensorBaseline* b = baseline_of(report, id);
    page.begin_details(fmt::format("Sensor {}: {}", id, text_of(s.verdict)));
    page.paragraph(fmt::format("{}: {}", worst.passage->name, s.reason));
    if (b != nullptr && b->impossible_because.empty())
        page.paragraph(fmt::format(
            "Baseline: {} passages, {} samples, root mean square {:.4g}; autoregressive model of "
            "order {} ({}; by AIC {}, by BIC {}), {} of its own points outside the limits.",
            b->passages, b->samples, b->rms, b->model.order(), text_of(report.settings.method),
            b->orders.by_aic, b->orders.by_bic, per_cent(b->outlier_share)));
    if (!s.points.times.empty()) {
        if (s.spectrum.segments > 0) page.plot(spectrum_plot(s, *b, report.settings.quantity));
        page.plot(chart_plot(s, report.settings.width));
        for (const Plot& plot : level_plots(s, report.settings)) page.plot(plot);
    }
    std::vector<std::vector<std::string>> rows{{"check", "finding"}};
    for (const Finding& f : worst.passage->findings)
        if (f.sensor == id)
            rows.push_back(
                {(f.kind == Finding::Kind::refusal ? "refused: " : "") + f.check, f.text});
    if (rows.size() > 1) page.table(rows);
    page.end_details();
}

} // namespace

namespace {

/// Share of the records that were received, without copies, that could not be used.
double lost_share(const StreamCounts& c) {
    const std::uint64_t distinct = c.received - (c.left_out - c.lost);
    return distinct > 0 ? static_cast<double>(c.lost) / static_cast<double>(distinct) : 0;
}

} // namespace

OverallVerdict overall_verdict(const MonitorReport& report) {
    if (report.records && report.tally.all() == 0)
        return {Verdict::not_enough_data,
                report.records->received == 0 ? "nothing was recorded" : "no train passed"};
    OverallVerdict v = overall_verdict(report.passages);
    if (v.verdict == Verdict::as_baseline)
        v.reason = report.tally.sentence();
    else if (report.tally.all() > 1)
        v.reason += "; " + report.tally.sentence();
    const double lost = report.records ? lost_share(*report.records) : 0;
    if (lost > report.settings.largest_missing && v.verdict == Verdict::as_baseline)
        v = {Verdict::not_enough_data,
             fmt::format("{:.0f} % of the records could not be used; {}", 100 * lost, v.reason)};
    return v;
}

std::string not_judged(const MonitorReport& report) {
    std::string text = report.tally.all() == 0 ? "no passage" : report.tally.not_judged();
    if (report.records && report.records->lost > 0)
        text += fmt::format("{}{} of {} records left out", text.empty() ? "" : "; ",
                            report.records->lost, report.records->received);
    return text;
}

Plot spectrum_plot(const SensorResult& result, const SensorBaseline& baseline,
                   VibrationQuantity quantity) {
    const Named q = name_of(quantity);
    Plot plot{.title = fmt::format("Sensor {}: spectrum of the {}", result.id, q.name),
              .x_label = "frequency (Hz)",
              .y_label = "density (" + q.density + ")",
              .y_logarithmic = true};
    const auto curve = [](const Spectrum& s, const std::string& label, double factor) {
        Curve c{label};
        for (std::size_t k = 1; k < s.density.size(); ++k) { // nothing is left at 0 Hz
            c.x.push_back(s.frequency(k));
            c.y.push_back(factor * s.density[k]);
        }
        return c;
    };
    plot.curves.push_back(curve(baseline.spectrum, "baseline", 1));
    plot.curves.push_back(curve(result.spectrum, "recording (dashed: 95 % confidence)", 1));
    const ConfidenceFactors f = confidence_factors(result.spectrum.degrees_of_freedom, 0.95);
    for (const double factor : {f.low, f.high}) {
        plot.curves.push_back(curve(result.spectrum, "", factor));
        plot.curves.back().style = Curve::Style::dashed;
    }
    return plot;
}

Plot chart_plot(const SensorResult& result, double width) {
    Plot plot{.title = fmt::format("Sensor {}: {} of the points outside the limits", result.id,
                                   per_cent(result.outlier_share)),
              .x_label = "time since the train came (s)",
              .y_label = "standard deviations of the baseline"};
    const ChartPoints& p = result.points;
    const std::vector<double> times = times_since_first(p);
    plot.curves.push_back({"mean of residuals", times, p.means, Curve::Style::points});
    plot.curves.push_back(
        {"logarithm of their deviation", times, p.deviations, Curve::Style::points});
    if (times.empty()) return plot;
    plot.curves.push_back({"limits", {0, times.back()}, {width, width}, Curve::Style::dashed});
    plot.curves.push_back({"", {0, times.back()}, {-width, -width}, Curve::Style::dashed});
    return plot;
}

void write_page(const std::filesystem::path& folder, const MonitorReport& report) {
    HtmlPage page("SmartRock monitor");
    const OverallVerdict overall = overall_verdict(report);
    page.verdict(kind_of(overall.verdict), text_of(overall.verdict), overall.reason);
    page.paragraph(fmt::format("Recordings: {}. Baseline: {}. Quantity: {}.", report.recordings,
                               report.baseline, name_of(report.settings.quantity).name));
    page.heading("Sensors");
    add_sensor_table(page, report);
    add_history(page, report);
    page.heading("Each sensor");
    page.paragraph("The most serious passage of each sensor.");
    for (const unsigned id : sensors_of(report)) add_sensor(page, report, id);
    if (!report.stream.empty()) {
        page.heading("Stream");
        page.paragraph(report.stream);
    }
    page.heading("How to read this page");
    page.paragraph(fmt::format(
        "A sensor has changed if more than {:g} % of its points lie outside the limits of a "
        "control "
        "chart: subgroups of {} residuals of the baseline's autoregressive model, their mean and "
        "the "
        "logarithm of their standard deviation, {:g} standard deviations of the baseline on either "
        "side. It is as the baseline only if its recording would show a change; otherwise there is "
        "not enough data.",
        100 * report.settings.alarm_share, report.settings.subgroup, report.settings.width));
    page.write(folder / "monitor.html");
}

void draw_pictures(const std::filesystem::path& folder, const MonitorReport& report) {
    std::vector<Plot> spectra, charts;
    constexpr std::size_t most = 12; // panels
    for (const unsigned id : sensors_of(report)) {
        const SensorResult& s = *most_serious_result(report.passages, id).sensor;
        if (s.points.times.empty() || charts.size() == most) continue;
        charts.push_back(chart_plot(s, report.settings.width));
        if (s.spectrum.segments > 0)
            spectra.push_back(spectrum_plot(s, *baseline_of(report, id), report.settings.quantity));
    }
    if (!spectra.empty()) draw_plots(folder / "spectra.png", spectra);
    if (!charts.empty()) draw_plots(folder / "charts.png", charts);
}

void add_results(Report& summary, const MonitorReport& report) {
    const OverallVerdict overall = overall_verdict(report);
    summary.add("verdict", text_of(overall.verdict));
    summary.add("reason", overall.reason);
    summary.add("passages", report.tally.all());
    summary.add("passages_as_baseline", report.tally.as_baseline);
    summary.add("passages_changed", report.tally.changed);
    summary.add("passages_not_judged",
                report.tally.all() - report.tally.as_baseline - report.tally.changed);
    if (report.records) {
        summary.add("records_received", report.records->received);
        summary.add("records_in_passages", report.records->in_passages);
        summary.add("records_quiet", report.records->quiet);
        summary.add("records_left_out", report.records->left_out);
    }
    for (const unsigned id : sensors_of(report)) {
        const OverallVerdict v = overall_verdict(report.passages, id);
        const SensorResult& s = *most_serious_result(report.passages, id).sensor;
        const SensorBaseline* b = baseline_of(report, id);
        Report sensor;
        const auto add = [&](const char* name, const auto& value) { sensor.add(name, value); };
        add("verdict", text_of(v.verdict));
        add("reason", v.reason);
        add("outlier_share", s.outlier_share);
        add("rms_ratio", s.level_ratio);
        const RatioInterval i = b ? power_interval(s, *b, report.settings) : RatioInterval{};
        add("power_ratio", s.power_ratio);
        add("power_ratio_low", i.low);
        add("power_ratio_high", i.high);
        add("spectral_entropy", s.entropy);
        add("roll_ratio", s.rotation_ratio.roll);
        add("pitch_ratio", s.rotation_ratio.pitch);
        add("yaw_ratio", s.rotation_ratio.yaw);
        add("ewma_share", s.ewma_share);
        add("cusum_share", s.cusum_share);
        if (b != nullptr) add("baseline_outlier_share", b->outlier_share);
        if (b != nullptr) add("model_order", b->model.order());
        sensor.show({"verdict", "outlier_share", "rms_ratio", "power_ratio"});
        summary.add_part(fmt::format("sensor_{}", id), sensor);
    }
    summary.show(
        {"verdict", "passages", "passages_as_baseline", "passages_changed", "passages_not_judged"});
    if (report.records) summary.show({"records_received", "records_left_out"});
    summary.show_sentence(overall.reason + ".");
}

} // namespace bris

#include "scenarios/monitoring/monitor_page.hpp"

#include "engine/io/html_page.hpp"
#include "engine/report.hpp"
#include "engine/run_page.hpp"
#include "scenarios/monitoring/features.hpp"
#include "scenarios/monitoring/passage_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace bris {

namespace {

std::string kind_of(Verdict verdict) {
    return is_change(verdict) ? "bad" : verdict == Verdict::as_baseline ? "good" : "unknown";
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

/// What the chosen quantity is called and measured in.
struct Named {
    std::string name, density;
};
Named name_of(VibrationQuantity quantity) {
    if (quantity == VibrationQuantity::vertical) return {"vertical acceleration", "(m/s2)2/Hz"};
    const std::string& text = text_of(quantity);
    return {text.substr(0, text.find('_')) + " rate", "(rad/s)2/Hz"};
}

/// What a track engineer does next.
const char* advice_for(Verdict verdict) {
    switch (verdict) {
    case Verdict::louder:
        return "Look at the track there: a hanging tie, mud, a weld or wheel flats of this train.";
    case Verdict::quieter:
        return "Check that the sensor still sits in the ballast; then look at the track: tamped or "
               "cemented ballast, or a lighter or slower train.";
    case Verdict::drifts:
        return "Compare speed, load and temperature of these passages; if they explain nothing, "
               "inspect the ballast and go on recording.";
    case Verdict::another_spectrum:
    case Verdict::another_motion:
        return "Compare train and speed with those of the baseline; then inspect tie and ballast.";
    case Verdict::moved:
        return "Look after the sensor; then record a new baseline with it.";
    case Verdict::as_baseline:
        return "Nothing.";
    case Verdict::no_train:
        return "Record a passage.";
    default:
        return "See the reason, and record again.";
    }
}

/// The first passage in order in which a sensor itself has changed.
std::string since(const MonitorReport& report, unsigned id) {
    for (const PassageResult& passage : report.passages)
        for (const SensorResult& s : passage.sensors)
            if (s.id == id && is_change(s.verdict)) return passage.name;
    return "-";
}

void add_sensor_table(HtmlPage& page, const MonitorReport& report) {
    std::vector<std::vector<std::string>> rows{{"sensor", "verdict", "what was found",
                                                "vertical vibration", "judged", "first changed in",
                                                "what to do"}};
    std::vector<std::string> kinds;
    for (const SensorSummary& s : report.sensors) {
        rows.push_back({fmt::format("{}", s.id), text_of(s.overall.verdict), s.overall.reason,
                        fmt::format("{} ({}-{} is not seen)", number(s.level_ratio),
                                    number(s.seen_below), number(s.seen_above)),
                        fmt::format("{}", s.judged), since(report, s.id),
                        advice_for(s.overall.verdict)});
        kinds.push_back(kind_of(s.overall.verdict));
    }
    page.table(rows, kinds);
    page.paragraph("Vertical vibration: root mean square over that of the baseline, geometric mean "
                   "of the passages judged; between the numbers in parentheses a lasting change "
                   "would not be seen in 90 % of such runs.");
}

/// How well the baseline is known.
void add_baseline(HtmlPage& page, const MonitorReport& report) {
    std::size_t sessions = 0, least = 0;
    double serial = 0;
    for (const SensorBaseline& b : report.baselines) {
        if (!b.impossible_because.empty()) continue;
        sessions = std::max(sessions, b.features.sessions());
        least = least == 0 ? b.features.passages() : std::min(least, b.features.passages());
        serial = b.features.serial();
    }
    page.paragraph(fmt::format(
        "Baseline: {}; {} passages or more of each sensor, correlation of successive ones {:.2f}, "
        "{}.",
        report.baseline, least, serial,
        sessions > 1
            ? fmt::format("{} sessions", sessions)
            : std::string("one session: how other days differ is not known, so that another "
                          "day's weather or trains may look like a change")));
    for (const SensorBaseline& b : report.baselines)
        if (b.left_out > 0)
            page.paragraph(
                fmt::format("Baseline of sensor {}: {} passages left out, the first one: {}.", b.id,
                            b.left_out, b.left_out_because));
}

void add_history(HtmlPage& page, const MonitorReport& report) {
    if (report.tally.all() < 2) return;
    page.heading("Passages");
    std::vector<std::vector<std::string>> rows{{"passage", "verdict", "reason"}};
    std::vector<std::string> kinds;
    constexpr std::size_t shown = PassageLog::most_last;
    const std::size_t first = report.passages.size() > shown ? report.passages.size() - shown : 0;
    for (std::size_t k = first; k < report.passages.size(); ++k) {
        const PassageResult& passage = report.passages[k];
        const Verdict verdict = verdict_on(passage);
        const auto worst = std::ranges::max_element(passage.sensors, {}, &SensorResult::verdict);
        rows.push_back({passage.name, text_of(verdict),
                        worst == passage.sensors.end()
                            ? ""
                            : fmt::format("sensor {}: {}", worst->id, worst->reason)});
        kinds.push_back(kind_of(verdict));
    }
    page.table(rows, kinds);
    page.paragraph("Each passage by itself. Of many unchanged passages some differ by chance; the "
                   "verdicts above take that into account.");
    if (report.tally.all() > shown)
        page.paragraph(
            fmt::format("The first {} passages are in history.csv.", report.tally.all() - shown));
}

std::vector<double> times_since_first(const ChartPoints& points) {
    std::vector<double> times;
    for (const double t : points.times) times.push_back(t - points.times.front());
    return times;
}

void add_features(HtmlPage& page, const SensorResult& s) {
    std::vector<std::vector<std::string>> rows{
        {"feature", "times the baseline", "standard deviations", "p", "seen from"}};
    std::vector<std::string> kinds;
    std::string left_out;
    for (std::size_t f = 0; f < s.features.size(); ++f) {
        const JudgedFeature& judged = s.features[f];
        const Feature& feature = all_features()[f];
        if (!std::isfinite(judged.p)) {
            left_out += (left_out.empty() ? "" : ", ") + std::string(feature.meaning);
            continue;
        }
        const bool is_ratio = feature.factor > 0;
        rows.push_back(
            {std::string(feature.meaning), is_ratio ? number(std::exp(judged.difference)) : "-",
             number(judged.difference / judged.deviation, "{:+.1f}"), number(judged.p, "{:.1g}"),
             is_ratio ? number(std::exp(judged.seen)) + " times"
                      : number(judged.seen / judged.deviation) + " deviations"});
        kinds.push_back(judged.is_changed ? "bad" : "good");
    }
    page.table(rows, kinds);
    if (!left_out.empty()) page.paragraph("Not judged: " + left_out + ".");
}

void add_report_rule(HtmlPage& page, const SensorResult& s, const MonitorReport& report) {
    std::vector<std::vector<std::string>> rows{
        {"rule of the SmartRock report", "points outside", "would call it"}};
    for (std::size_t k = 0; k < readings.size(); ++k) {
        std::string name(readings[k]);
        std::ranges::replace(name, '_', ' ');
        const double share = s.outlier_shares[k];
        rows.push_back({name, per_cent(share),
                        !std::isfinite(share)                             ? "-"
                        : share > report.settings.report_rule.alarm_share ? "changed"
                                                                          : "as the baseline"});
    }
    page.table(rows);
}

/// The level of a sensor in all passages that are kept, over that of the baseline.
Plot history_plot(const MonitorReport& report, unsigned id) {
    Plot plot{.title = fmt::format("Sensor {}: vertical vibration", id),
              .x_label = "passage",
              .y_label = "times the baseline",
              .y_logarithmic = true};
    Curve level{"passages", {}, {}, Curve::Style::points}, above{"seen in 90 %"}, below{""};
    double passage = 0;
    for (const PassageResult& one : report.passages) {
        ++passage;
        for (const SensorResult& s : one.sensors) {
            if (s.id != id || s.features.empty()) continue;
            for (auto& [curve, y] : {std::pair{&level, s.level_ratio()},
                                     {&above, s.seen_above()},
                                     {&below, s.seen_below()}}) {
                curve->x.push_back(passage);
                curve->y.push_back(y);
            }
        }
    }
    above.style = below.style = Curve::Style::dashed;
    plot.curves = {level, above, below};
    return plot;
}

void add_sensor(HtmlPage& page, const MonitorReport& report, const SensorSummary& of) {
    const MostSerious worst = most_serious_result(report.passages, of.id);
    const SensorResult& s = *worst.sensor;
    const SensorBaseline* b = baseline_of(report, of.id);
    page.begin_details(fmt::format("Sensor {}: {}", of.id, text_of(of.overall.verdict)));
    page.paragraph(fmt::format("Most serious passage, {}: {}: {}", worst.passage->name,
                               text_of(s.verdict), s.reason));
    if (b != nullptr && b->impossible_because.empty())
        page.paragraph(fmt::format(
            "Baseline: {} passages, {} samples, root mean square {:.4g}; autoregressive model of "
            "order {} ({}; by AIC {}, by BIC {}).",
            b->features.passages(), b->samples, b->rms, b->model.order(),
            text_of(report.settings.method), b->orders.by_aic, b->orders.by_bic));
    if (!s.features.empty()) {
        add_features(page, s);
        if (of.judged > 1) page.plot(history_plot(report, of.id));
        add_report_rule(page, s, report);
    }
    if (!s.points.times.empty()) {
        if (s.spectrum.segments > 0 && b->spectrum.segments > 0)
            page.plot(spectrum_plot(s, *b, report.settings.quantity));
        page.plot(chart_plot(s, report.settings.report_rule.width));
    }
    std::vector<std::vector<std::string>> rows{{"check", "finding"}};
    for (const Finding& f : worst.passage->findings)
        if (f.sensor == of.id)
            rows.push_back(
                {(f.kind == Finding::Kind::refusal ? "refused: " : "") + f.check, f.text});
    if (rows.size() > 1) page.table(rows);
    page.end_details();
}

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
    OverallVerdict v = overall_verdict(report.sensors);
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
                                   per_cent(result.outlier_shares.front())),
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

void write_page(const Common& common, const MonitorReport& report) {
    HtmlPage page("SmartRock monitor");
    const OverallVerdict overall = overall_verdict(report);
    page.verdict(kind_of(overall.verdict), text_of(overall.verdict), overall.reason);
    page.paragraph(fmt::format("Recordings: {}. Quantity: {}.", report.recordings,
                               name_of(report.settings.quantity).name));
    add_baseline(page, report);
    page.heading("Sensors");
    add_sensor_table(page, report);
    add_history(page, report);
    page.heading("Each sensor");
    for (const SensorSummary& s : report.sensors) add_sensor(page, report, s);
    for (const auto& [heading, text] :
         {std::pair{"Stream", report.stream}, {"Files", report.notes}})
        if (!text.empty()) {
            page.heading(heading);
            page.paragraph(text);
        }
    page.heading("How to read this page");
    page.paragraph(fmt::format(
        "Levels, spectrum, model and rotations of each passage are compared with how they scatter "
        "between passages of the baseline. If nothing has changed, the probability of any alarm is "
        "at most {:g} % in a passage, and in all passages of this page together. A sensor is as "
        "the baseline only if its recording would show a change; otherwise there is not enough "
        "data.",
        100 * report.settings.false_alarms));
    page.paragraph("It cannot tell fouled ballast from another train, speed or weather unless the "
                   "baseline has them and their numbers are stated; nor a loose sensor from loose "
                   "ballast, if it is the only one that has changed.");
    add_origin(page, common);
    page.write(common.out / "monitor.html");
}

void draw_pictures(const std::filesystem::path& folder, const MonitorReport& report) {
    std::vector<Plot> spectra, charts, histories;
    constexpr std::size_t most = 12; // panels
    for (const SensorSummary& of : report.sensors) {
        const SensorResult& s = *most_serious_result(report.passages, of.id).sensor;
        if (of.judged > 1 && histories.size() < most)
            histories.push_back(history_plot(report, of.id));
        if (s.points.times.empty() || charts.size() == most) continue;
        charts.push_back(chart_plot(s, report.settings.report_rule.width));
        const SensorBaseline& b = *baseline_of(report, of.id);
        if (s.spectrum.segments > 0 && b.spectrum.segments > 0)
            spectra.push_back(spectrum_plot(s, b, report.settings.quantity));
    }
    if (!spectra.empty()) draw_plots(folder / "spectra.png", spectra);
    if (!charts.empty()) draw_plots(folder / "charts.png", charts);
    if (!histories.empty()) draw_plots(folder / "history.png", histories);
}

void add_results(Report& summary, const MonitorReport& report) {
    const OverallVerdict overall = overall_verdict(report);
    summary.add("verdict", text_of(overall.verdict));
    summary.add("reason", overall.reason);
    summary.add("false_alarms", report.settings.false_alarms);
    summary.add("passages", report.tally.all());
    summary.add("passages_as_baseline", report.tally.count(Verdict::as_baseline));
    summary.add("passages_changed", report.tally.changed());
    summary.add("passages_not_judged", report.tally.not_judged_count());
    if (report.records) {
        summary.add("records_received", report.records->received);
        summary.add("records_in_passages", report.records->in_passages);
        summary.add("records_quiet", report.records->quiet);
        summary.add("records_left_out", report.records->left_out);
    }
    for (const SensorSummary& of : report.sensors) {
        const SensorBaseline* b = baseline_of(report, of.id);
        Report sensor;
        const auto add = [&](const char* name, const auto& value) { sensor.add(name, value); };
        add("verdict", text_of(of.overall.verdict));
        add("reason", of.overall.reason);
        add("passages_judged", of.judged);
        add("rms_ratio", of.level_ratio);
        add("rms_ratio_seen_below", of.seen_below);
        add("rms_ratio_seen_above", of.seen_above);
        add("change_a_passage", of.change_a_passage);
        if (b != nullptr) add("baseline_passages", b->features.passages());
        if (b != nullptr) add("model_order", b->model.order());
        sensor.show({"verdict", "passages_judged", "rms_ratio", "rms_ratio_seen_below",
                     "rms_ratio_seen_above"});
        summary.add_part(fmt::format("sensor_{}", of.id), sensor);
    }
    summary.show(
        {"verdict", "passages", "passages_as_baseline", "passages_changed", "passages_not_judged"});
    if (report.records) summary.show({"records_received", "records_left_out"});
    summary.show_sentence(overall.reason + ".");
}

} // namespace bris

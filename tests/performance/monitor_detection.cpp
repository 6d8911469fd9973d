// How often does the monitor detect a change, and how often does it raise a false alarm? Synthetic
// passages that the baseline has not seen; nothing here is a claim about ballast.
#include "engine/ensemble.hpp"
#include "engine/estimation/student_t.hpp"
#include "engine/io/csv.hpp"
#include "engine/scenario.hpp"
#include "engine/signal/median.hpp"
#include "engine/summary.hpp"
#include "scenarios/monitoring/sensor_verdict.hpp"
#include "scenarios/monitoring/synthetic_vibration.hpp"
#include "tests/detection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

struct Detection {
    unsigned sites = 200, baseline_passages = 12, sensors = 1;
    double duration = 6, level_false_alarms = 0.01;
    SyntheticVibration vibration;
    MonitorSettings settings;
    void declare_options(auto& option) {
        option("sites", sites, "",
               "Sites with a baseline of their own, and one new passage in each state: the "
               "independent trials.",
               within(2, 10000));
        option("baseline_passages", baseline_passages, "", "Passages in a baseline.",
               within(4, 1000));
        option("sensors", sensors, "", "Sensors of a site.", within(1, 100));
        option("level_false_alarms", level_false_alarms, "",
               "Share of false alarms of the plain level, which is compared: Student's t of the "
               "logarithm of the root mean square of a passage.",
               within(0.001, 0.5));
        option("passage_scatter", vibration.passage_scatter, "",
               "Standard deviation of the logarithm of the level from passage to passage.",
               within(0, 1));
        option("duration", duration, "s", "Time that a passage takes.", within(3, 600));
        settings.declare_options(option);
    }
};

struct State {
    std::string name;
    SyntheticState factors;
};

const std::vector<State>& states() {
    static const std::vector<State> all{{"clean", {}},
                                        {"level x 0.8", {.level = 0.8}},
                                        {"level x 0.6", {.level = 0.6}},
                                        {"level x 1.25", {.level = 1.25}},
                                        {"level x 1.41", {.level = 1.41}},
                                        {"level x 1.7", {.level = 1.7}},
                                        {"level x 2 (fouled)", synthetic_state("fouled")},
                                        {"roll x 1.5", {.roll = 1.5}},
                                        {"resonances x 0.75", synthetic_state("loosened")}};
    return all;
}

/// What is said of one passage: by the monitor, by the plain level of any sensor, and by the
/// residual charts of the report.
struct Said {
    bool monitor = false, level = false, charts = false;
    double score = 0;                      ///< the least p of the monitor, as -ln
    double seen_below = 0, seen_above = 0; ///< ratios of the first sensor
};

/// The ln of the root mean square of the active samples, in deviations of those of the baseline.
double plain_level(const std::vector<double>& baseline, double found) {
    const auto n = static_cast<double>(baseline.size());
    double mean = 0, squares = 0;
    for (const double x : baseline) mean += x / n;
    for (const double x : baseline) squares += (x - mean) * (x - mean);
    return (found - mean) / std::sqrt(squares / (n - 1) * (1 + 1 / n));
}

double level_in(const Recording& r, double threshold) {
    const Vibration v = vibration_of(r, VibrationQuantity::vertical, 1);
    double squares = 0, n = 0;
    for (const auto& run : runs_in(v, active_ranges(v, threshold, 0.2)))
        for (const double x : run) squares += x * x, ++n;
    return 0.5 * std::log(squares / n);
}

std::vector<Said> examine_site(const Detection& d, std::uint64_t seed) {
    unsigned next = 1;
    const auto passage = [&](const SyntheticState& state) {
        return synthetic_passage(d.vibration, state, seed, next++, "passage");
    };
    std::vector<Passage> good;
    for (unsigned k = 0; k < d.baseline_passages; ++k) good.push_back(passage({}));
    const auto baselines = baselines_of(good, d.settings);
    std::vector<std::vector<double>> levels(d.sensors);
    for (const Passage& p : good)
        for (std::size_t s = 0; s < d.sensors; ++s)
            levels[s].push_back(level_in(p.recordings[s], baselines[s].train_threshold));
    const double limit =
        student_t_quantile(1 - d.level_false_alarms / d.sensors / 2, d.baseline_passages - 1);
    std::vector<Said> said;
    for (const State& state : states()) {
        const Passage p = passage(state.factors);
        const PassageResult result = judge_passage(p, baselines, d.settings);
        Said& one = said.emplace_back();
        one.monitor = is_change(verdict_on(result)) || verdict_on(result) == Verdict::moved;
        double least = 1;
        for (std::size_t s = 0; s < d.sensors; ++s) {
            const SensorResult& sensor = result.sensors[s];
            for (const JudgedFeature& f : sensor.features)
                if (f.p < least) least = f.p;
            one.charts |= sensor.outlier_shares.front() > d.settings.report_rule.alarm_share;
            one.level |=
                std::abs(plain_level(
                    levels[s], level_in(p.recordings[s], baselines[s].train_threshold))) > limit;
        }
        one.score = -std::log(std::max(least, 1e-300));
        one.seen_below = result.sensors.front().seen_below();
        one.seen_above = result.sensors.front().seen_above();
    }
    return said;
}

/// Probability of at least `against` of all that differ, if both rules were equally good (McNemar,
/// exact, one-sided).
double p_of_fewer(std::size_t in_favour, std::size_t against) {
    const double n = static_cast<double>(in_favour + against);
    double p = 0;
    for (double k = static_cast<double>(against); k <= n; ++k)
        p += std::exp(std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1) -
                      n * std::log(2.0));
    return std::min(1.0, p);
}

void run(const Detection& given, const Common& common) {
    Detection d = given;
    d.vibration.duration = d.duration;
    d.vibration.sensors = d.sensors;
    std::vector<std::vector<Said>> sites(d.sites);
    run_ensemble(d.sites, common.threads,
                 [&](std::size_t k) { sites[k] = examine_site(d, 1000 * common.seed + k); });
    fmt::print("{:<20} {:>24} {:>24} {:>24} {:>10} {:>22} {:>12}\n", "state",
               fmt::format("monitor, {:g} %", 100 * d.settings.false_alarms),
               fmt::format("level, {:g} %", 100 * d.level_false_alarms), "charts of the report",
               "p (fewer)", "area under ROC", "seen");
    std::vector<std::vector<double>> rows;
    Summary summary;
    std::size_t in_favour = 0, against = 0;
    for (std::size_t s = 0; s < states().size(); ++s) {
        std::size_t monitor = 0, level = 0, charts = 0, more = 0, fewer = 0;
        std::vector<double> clean, scores, below, above;
        for (const auto& site : sites) {
            const Said& one = site[s];
            monitor += one.monitor;
            level += one.level;
            charts += one.charts;
            more += one.monitor && !one.level;
            fewer += one.level && !one.monitor;
            scores.push_back(one.score);
            clean.push_back(site[0].score);
            below.push_back(one.seen_below);
            above.push_back(one.seen_above);
        }
        if (s > 0) in_favour += more, against += fewer;
        const auto share = [&](std::size_t count) {
            const ConfidenceInterval i = binomial_interval(count, d.sites);
            return fmt::format("{} of {} ({:.2f}-{:.2f})", count, d.sites, i.low, i.high);
        };
        const double area = area_under_roc(clean, scores);
        const ConfidenceInterval i =
            bootstrap_area_under_roc(clean, scores, 0.95, 1000, common.seed);
        fmt::print(
            "{:<20} {:>24} {:>24} {:>24} {:>10.3g} {:>22} {:>5.2f}-{:<5.2f}\n", states()[s].name,
            share(monitor), share(level), share(charts), p_of_fewer(more, fewer),
            s == 0 ? std::string("-") : fmt::format("{:.3f} ({:.3f}-{:.3f})", area, i.low, i.high),
            median(below), median(above));
        rows.push_back(
            {static_cast<double>(s), static_cast<double>(monitor), static_cast<double>(level),
             static_cast<double>(charts), static_cast<double>(d.sites), static_cast<double>(more),
             static_cast<double>(fewer), area, i.low, i.high, median(below), median(above)});
    }
    fmt::print("all changed states: monitor alone {}, level alone {} (p of fewer {:.2g})\n",
               in_favour, against, p_of_fewer(in_favour, against));
    write_csv(common.out / "detection.csv",
              {"state", "alarms_monitor", "alarms_level", "alarms_charts", "passages",
               "monitor_alone", "level_alone", "auc", "auc_low", "auc_high", "seen_below",
               "seen_above"},
              rows, {"state: number of the row in the printed table, from 0"}, 6);
    summary.add("false_alarms", rows.front()[1] / static_cast<double>(d.sites));
    summary.add("p_of_fewer_than_level", p_of_fewer(in_favour, against));
    report_results(common, summary);
}

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    return bris::run_scenario<bris::Detection>(
        argc, argv,
        {.name = "monitor_detection",
         .description = "Measures detection and false alarms of the monitor on synthetic passages "
                        "that the baseline has not seen.",
         .cannot_resume = "it takes a minute",
         .cannot_explain = "it runs no time steps"},
        bris::run);
}

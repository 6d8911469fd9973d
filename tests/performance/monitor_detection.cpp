// How often does the monitor detect a change, and how often does it raise a false alarm? Synthetic
// passages that the baseline has not seen; nothing here is a claim about ballast.
#include "engine/ensemble.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/plot.hpp"
#include "engine/scenario.hpp"
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
    unsigned sites = 40, baseline_passages = 12, training_passages = 10;
    double duration = 6, false_alarms = 0.05;
    SyntheticVibration vibration{.sensors = 1};
    MonitorSettings settings;
    void declare_options(auto& option) {
        option("sites", sites, "",
               "Sensors with a baseline of their own, and one new passage in "
               "each state: the independent trials.",
               within(2, 10000));
        option("baseline_passages", baseline_passages, "", "Passages in a baseline.",
               within(2, 1000));
        option("training_passages", training_passages, "",
               "Further clean passages of each site by which the alarm share is calibrated.",
               within(1, 1000));
        option("false_alarms", false_alarms, "", "Share of false alarms to which it is calibrated.",
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
                                        {"level x 1.2", {.level = 1.2}},
                                        {"level x 1.41", {.level = 1.41}},
                                        {"level x 1.7", {.level = 1.7}},
                                        {"level x 2 (fouled)", synthetic_state("fouled")},
                                        {"resonances x 0.75", synthetic_state("loosened")}};
    return all;
}

/// Shares of outliers of one site: clean training passages, then one passage in each state.
struct Site {
    std::vector<double> training, unseen;
};

Site examine_site(const Detection& d, std::uint64_t seed) {
    unsigned next = 1;
    const auto passage = [&](const SyntheticState& state) {
        return synthetic_passage(d.vibration, state, seed, next++, "passage");
    };
    std::vector<Passage> good;
    for (unsigned k = 0; k < d.baseline_passages; ++k) good.push_back(passage({}));
    const auto baselines = baselines_of(good, d.settings);
    const auto score = [&](const SyntheticState& state) {
        return judge_passage(passage(state), baselines, d.settings).sensors.front().outlier_share;
    };
    Site site;
    for (unsigned k = 0; k < d.training_passages; ++k) site.training.push_back(score({}));
    for (const State& state : states()) site.unseen.push_back(score(state.factors));
    return site;
}

void run(const Detection& given, const Common& common) {
    Detection d = given;
    d.vibration.duration = d.duration;
    std::vector<Site> sites(d.sites);
    run_ensemble(d.sites, common.threads,
                 [&](std::size_t k) { sites[k] = examine_site(d, 1000 * common.seed + k); });
    std::vector<double> training;
    std::vector<std::vector<double>> unseen(states().size());
    for (const Site& site : sites) {
        training.insert(training.end(), site.training.begin(), site.training.end());
        for (std::size_t s = 0; s < unseen.size(); ++s) unseen[s].push_back(site.unseen[s]);
    }
    std::ranges::sort(training);
    const double calibrated = training[std::min(
        training.size() - 1, static_cast<std::size_t>(std::ceil(
                                 (1 - d.false_alarms) * static_cast<double>(training.size()))))];
    fmt::print("alarm share calibrated on {} clean passages to {:g} % false alarms: {:.3f}\n\n",
               training.size(), 100 * d.false_alarms, calibrated);
    fmt::print("{:<20} {:>12} {:>26} {:>26} {:>22}\n", "state", "median share",
               fmt::format("alarms at {:g} %", 100 * d.settings.alarm_share),
               fmt::format("alarms at {:.1f} %", 100 * calibrated), "area under ROC");
    std::vector<std::vector<double>> rows;
    Plot roc{.title = "Detection of a change by one passage (synthetic)",
             .x_label = "false alarms",
             .y_label = "detections"};
    for (std::size_t s = 0; s < unseen.size(); ++s) {
        std::vector<double> sorted = unseen[s];
        std::ranges::sort(sorted);
        const auto alarms = [&](double limit) {
            return static_cast<std::size_t>(
                std::ranges::count_if(sorted, [&](double x) { return x > limit; }));
        };
        const auto share = [&](std::size_t count) {
            const ConfidenceInterval i = binomial_interval(count, sorted.size());
            return fmt::format("{} of {} ({:.2f}-{:.2f})", count, sorted.size(), i.low, i.high);
        };
        const std::size_t by_report = alarms(d.settings.alarm_share), by_limit = alarms(calibrated);
        const double area = area_under_roc(unseen[0], unseen[s]);
        const ConfidenceInterval i =
            bootstrap_area_under_roc(unseen[0], unseen[s], 0.95, 2000, common.seed);
        fmt::print("{:<20} {:>12.3f} {:>26} {:>26} {:>22}\n", states()[s].name,
                   sorted[sorted.size() / 2], share(by_report), share(by_limit),
                   s == 0 ? std::string("-")
                          : fmt::format("{:.3f} ({:.3f}-{:.3f})", area, i.low, i.high));
        rows.push_back({static_cast<double>(s), sorted[sorted.size() / 2],
                        static_cast<double>(by_report), static_cast<double>(by_limit),
                        static_cast<double>(sorted.size()), area, i.low, i.high});
        if (s == 0) continue;
        Curve curve{states()[s].name, {0}, {0}};
        for (const RocPoint& p : roc_curve(unseen[0], unseen[s])) {
            curve.x.push_back(p.false_alarms);
            curve.y.push_back(p.detections);
        }
        roc.curves.push_back(std::move(curve));
    }
    write_csv(common.out / "detection.csv",
              {"state", "median_share", "alarms_fixed", "alarms_calibrated", "passages", "auc",
               "auc_low", "auc_high"},
              rows, {"state: number of the row in the printed table, from 0"}, 6);
    draw_plots(common.out / "detection.png", {roc}, 1);
    Summary summary;
    summary.add("calibrated_alarm_share", calibrated);
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

#include "scenarios/forecast/forecast_results.hpp"

#include "engine/io/csv.hpp"
#include "engine/io/plot.hpp"
#include "engine/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace bris {

namespace {

constexpr double low = 0.05, high = 0.95; // ends of the 90 % band

void add_rock(Report& summary, const ForecastResults& r, std::size_t rock) {
    const DeflectionForecast& f = r.forecast.rocks[rock];
    const std::string& name = r.names[rock];
    const auto add = [&](const char* what, double metres) {
        summary.add(fmt::format("{}_{}_mm", name, what), 1e3 * metres);
    };
    if (f.recorded)
        summary.add(name + "_recorded_compliance_um_per_kN", 1e9 * f.recorded->compliance);
    add("next_deflection_median", f.quantile(0.5));
    add("next_deflection_low", f.quantile(low));
    add("next_deflection_high", f.quantile(high));
    summary.show({name + "_next_deflection_median_mm"});
    if (r.found) add("next_deflection_found", r.found->rocks[rock].deflection);
}

std::size_t used_of(const ForecastResults& r) {
    return static_cast<std::size_t>(std::ranges::count_if(
        r.recordings, [](const JudgedRecording& one) { return one.left_out_because.empty(); }));
}

bool is_judged(const ForecastResults& r, std::size_t rock) {
    return std::ranges::find(r.recordings, rock, &JudgedRecording::sensor) != r.recordings.end();
}

void add_recordings(Report& summary, const ForecastResults& r) {
    summary.add("recordings", r.recordings.size());
    summary.add("recordings_used", used_of(r));
    for (const JudgedRecording& one : r.recordings) {
        const std::string& name = r.names[one.sensor];
        summary.add(name + "_recording_left_out_because", one.left_out_because);
        if (one.fit.speed == 0) continue;
        summary.add(name + "_goodness_of_fit", one.fit.goodness);
        summary.add(name + "_best_speed_m_per_s", one.fit.speed);
        summary.add(name + "_fit_p_value", one.fit.p_value);
    }
}

/// Share of the members whose rock was deflected further under the recorded train.
double share_above(const ForecastResults& r, double threshold) {
    const auto exceed = std::ranges::count_if(r.members, [&](const MemberMovements& m) {
        return m.last.rocks[r.rock].deflection > threshold;
    });
    return static_cast<double>(exceed) / static_cast<double>(r.members.size());
}

/// m/N, the least and the greatest of the rock that is judged.
std::pair<double, double> compliances_of_members(const ForecastResults& r) {
    std::vector<double> all;
    for (const MemberMovements& m : r.members) all.push_back(m.last.rocks[r.rock].compliance);
    const auto [least, most] = std::ranges::minmax(all);
    return {least, most};
}

Curve load_curve(const std::vector<double>& turns, const std::string& label) {
    const LoadHistory history = load_through(turns, 0.5);
    Curve curve{.label = label, .x = history.times, .y = history.values};
    for (double& y : curve.y) y *= 1e-3;
    return curve;
}

Plot loads(const ForecastResults& r) {
    return {.title = "Load of the rails on a tie",
            .x_label = "load cycle",
            .y_label = "load (kN)",
            .curves = {load_curve(r.last_turns, "recorded train"),
                       load_curve(r.next_turns, "next train")}};
}

/// Members as points; the recorded deflection with the band of the forecast as a vertical line.
Plot members(const ForecastResults& r) {
    Curve points{.label = "members", .style = Curve::Style::points},
        band{.label = "forecast, 90 %"}, found{.label = "site", .style = Curve::Style::points},
        limit{.label = "threshold"};
    limit.style = Curve::Style::dashed;
    double least = 1e9, most = 0;
    const auto note = [&](double x) {
        least = std::min(least, x);
        most = std::max(most, x);
    };
    for (const MemberMovements& m : r.members) {
        points.x.push_back(1e9 * m.last.rocks[r.rock].compliance);
        points.y.push_back(1e3 * m.next.rocks[r.rock].deflection);
        note(points.x.back());
    }
    const DeflectionForecast& f = r.forecast.rocks[r.rock];
    if (f.recorded) {
        const double x = 1e9 * f.recorded->compliance;
        note(x);
        band.x = {x, x};
        band.y = {1e3 * f.quantile(low), 1e3 * f.quantile(high)};
        if (r.found) {
            found.x = {x};
            found.y = {1e3 * r.found->rocks[r.rock].deflection};
        }
    }
    limit.x = {least, most};
    limit.y = {1e3 * r.threshold, 1e3 * r.threshold};
    std::vector<Curve> curves{points, limit};
    if (f.recorded) curves.push_back(band);
    if (!found.x.empty()) curves.push_back(found);
    return {.title = fmt::format("The rock {}", r.names[r.rock]),
            .x_label = "compliance under the recorded train (um/kN)",
            .y_label = "deflection under the next train (mm)",
            .curves = curves};
}

Plot probabilities(const ForecastResults& r) {
    const DeflectionForecast& f = r.forecast.rocks[r.rock];
    Curve with{.label = f.recorded ? "from the recordings" : "no recording"},
        without{.label = "members alone", .style = Curve::Style::dashed},
        limit{.label = "threshold"};
    limit.style = Curve::Style::dashed;
    const double most = 1e3 * std::max({2 * r.threshold, f.quantile(0.99)});
    constexpr int parts = 200;
    for (int k = 1; k <= parts; ++k) {
        const double x = most * k / parts;
        with.x.push_back(x);
        with.y.push_back(f.probability_above(1e-3 * x));
        without.x.push_back(x);
        without.y.push_back(f.members.probability_above(std::log(1e-3 * x)));
    }
    limit.x = {1e3 * r.threshold, 1e3 * r.threshold};
    limit.y = {0, 1};
    return {.title = "Probability that the deflection exceeds a value",
            .x_label = "deflection under the next train (mm)",
            .y_label = "probability",
            .curves = {with, without, limit}};
}

} // namespace

std::string sentence_of(const ForecastResults& r) {
    const DeflectionForecast& f = r.forecast.rocks[r.rock];
    std::string text = fmt::format(
        "under the next train the rock {} is deflected by {:.2f} mm (90 %: {:.2f} to {:.2f} mm), "
        "and by more than {:g} mm with a probability of {:.0f} %",
        r.names[r.rock], 1e3 * f.quantile(0.5), 1e3 * f.quantile(low), 1e3 * f.quantile(high),
        1e3 * r.threshold, 100 * f.probability_above(r.threshold));
    if (const auto used = used_of(r); used < r.recordings.size())
        text += fmt::format("\n{} of {} recordings are used, the others are left out", used,
                            r.recordings.size());
    if (!f.recorded)
        return text + fmt::format("\nit {}: this is what the members say",
                                  is_judged(r, r.rock) ? "has no recording of this train"
                                                       : "was not recorded");
    if (const auto [least, most] = compliances_of_members(r);
        f.recorded->compliance < least || f.recorded->compliance > most)
        text += fmt::format("\nits recorded compliance, {:.1f} um/kN, lies outside those of the "
                            "members, {:.1f} to {:.1f}: the forecast extrapolates",
                            1e9 * f.recorded->compliance, 1e9 * least, 1e9 * most);
    return text;
}

void add_forecast(Report& summary, const ForecastResults& r) {
    const DeflectionForecast& f = r.forecast.rocks[r.rock];
    summary.add("judged_rock", r.names[r.rock]);
    summary.add("threshold_mm", 1e3 * r.threshold);
    summary.add("probability_of_exceeding", f.probability_above(r.threshold));
    const auto [least, most] = compliances_of_members(r);
    summary.add("members_least_compliance_um_per_kN", 1e9 * least);
    summary.add("members_greatest_compliance_um_per_kN", 1e9 * most);
    summary.add("probability_by_members_alone", f.members.probability_above(std::log(r.threshold)));
    summary.add("share_of_members_above_threshold_under_recorded_train",
                share_above(r, r.threshold));
    if (!r.recordings.empty()) add_recordings(summary, r);
    if (r.found) summary.add("threshold_exceeded", r.found->rocks[r.rock].deflection > r.threshold);
    for (std::size_t rock = 0; rock < r.names.size(); ++rock) add_rock(summary, r, rock);
    const Predictive& s = r.forecast.settlement;
    summary.add("tie_next_settlement_median_mm", 1e3 * s.quantile(0.5));
    summary.add("tie_next_settlement_low_mm", 1e3 * s.quantile(low));
    summary.add("tie_next_settlement_high_mm", 1e3 * s.quantile(high));
    if (r.found) summary.add("tie_next_settlement_found_mm", 1e3 * r.found->tie.settlement);
    std::size_t inside = 0;
    double squares = 0;
    for (const auto& [found, forecast] : r.left_out) {
        inside += found >= forecast.quantile(low) && found <= forecast.quantile(high) ? 1u : 0u;
        squares += std::pow(std::log(found / forecast.quantile(0.5)), 2);
    }
    const auto n = static_cast<double>(r.left_out.size());
    summary.add("members_within_bands_of_the_others", inside);
    summary.add("members", r.members.size());
    summary.add("members_relative_error_from_the_others", std::sqrt(squares / n));
    summary.add("load_cycles_of_recorded_train", cycles_of(r.last_turns));
    summary.add("load_cycles_of_next_train", cycles_of(r.next_turns));
    summary.add("largest_load_of_recorded_train_kN", 1e-3 * std::ranges::max(r.last_turns));
    summary.add("largest_load_of_next_train_kN", 1e-3 * std::ranges::max(r.next_turns));
}

void write_probabilities(const std::filesystem::path& csv, const ForecastResults& r) {
    const DeflectionForecast& f = r.forecast.rocks[r.rock];
    std::vector<std::vector<double>> rows;
    for (int k = 1; k <= 30; ++k) {
        const double threshold = 1e-4 * k; // m
        rows.push_back({0.1 * k, f.probability_above(threshold),
                        f.members.probability_above(std::log(threshold)),
                        share_above(r, threshold)});
    }
    write_csv(csv,
              {"threshold_mm", "probability", "probability_by_members_alone",
               "share_of_members_under_recorded_train"},
              rows,
              {"Probability that the deflection of the rock " + r.names[r.rock] +
               " under the next train exceeds a threshold"},
              8);
}

void draw_forecast(const std::filesystem::path& png, const ForecastResults& r) {
    draw_plots(png, {loads(r), members(r), probabilities(r)});
}

} // namespace bris

#include "scenarios/monitoring/sensor_verdict.hpp"

#include "scenarios/monitoring/vibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace bris {

namespace {

/// Whether a recording has the samples of one of the baseline.
bool is_of_baseline(const Recording& r, const SensorBaseline& baseline) {
    const Beginnings own(r);
    return std::ranges::any_of(baseline.recorded,
                               [&](const Beginnings& other) { return own.are_those_of(other); });
}

/// Length (s) of the runs that are long enough for a point of the charts.
double usable_duration(const Vibration& v, std::size_t samples_needed) {
    std::size_t samples = 0;
    for (const auto& run : v.runs)
        if (run.size() >= samples_needed) samples += run.size();
    return static_cast<double>(samples) / v.rate;
}

/// Why nothing can be said of a recording; empty: something can.
/// `v`: the whole recording; `train`: the part in which a train passes.
std::string reason_against(const Recording& r, const Vibration& v, const Vibration& train,
                           const SensorBaseline& baseline, const std::string& refusal,
                           const MonitorSettings& s) {
    if (!baseline.impossible_because.empty()) return "no baseline: " + baseline.impossible_because;
    if (r.size() == 0) return "no samples";
    if (!refusal.empty()) return "refused by quality control: " + refusal;
    if (!v.impossible_because.empty()) return v.impossible_because;
    if (v.rate != baseline.rate)
        return fmt::format("sampling rate: expected {:g} Hz as in the baseline, found {:g}",
                           baseline.rate, v.rate);
    if (v.measured_rate > 1.02 * v.rate)
        return fmt::format("sampling rate: expected {:g} Hz as in the metadata, found {:.4g} by "
                           "the times",
                           v.rate, v.measured_rate);
    if (v.missing > s.largest_missing)
        return fmt::format("gaps: expected at most {:g} % of the samples missing, found {:.1f} %",
                           100 * s.largest_missing, 100 * v.missing);
    if (v.saturated > s.largest_saturated)
        return fmt::format("saturation: expected at most {:g} % of the samples at the end of the "
                           "range, found {:.2f} %",
                           100 * s.largest_saturated, 100 * v.saturated);
    if (is_of_baseline(r, baseline)) return "its samples are those of a recording of the baseline";
    const double usable = usable_duration(train, baseline.model.order() + s.subgroup);
    if (!train.runs.empty() && usable < s.least_duration)
        return fmt::format("too short: expected at least {:g} s without gaps while a train passes, "
                           "found {:.3g} s",
                           s.least_duration, usable);
    return {};
}

double share_of(std::size_t count, std::size_t all) {
    return all > 0 ? static_cast<double>(count) / static_cast<double>(all) : SensorResult::unknown;
}

/// Moving average and cumulative sums of the standardised deviations, beside the chart.
void follow_level(SensorResult& result, const MonitorSettings& s) {
    Ewma average(s.ewma_weight, s.ewma_width);
    Cusum sums(s.cusum_allowance, s.cusum_limit);
    std::size_t by_average = 0, by_sums = 0;
    for (const double z : result.points.deviations) {
        by_average += average.add(z);
        by_sums += sums.add(z);
    }
    result.ewma_share = share_of(by_average, result.points.deviations.size());
    result.cusum_share = share_of(by_sums, result.points.deviations.size());
}

void compare(SensorResult& result, const Recording& r, const Vibration& v,
             const SensorBaseline& baseline, const MonitorSettings& s) {
    result.level_ratio = v.rms / baseline.rms;
    result.points = chart_points(baseline, v.runs, v.begins, s);
    result.outlier_share = result.points.outlier_share(s.width);
    follow_level(result, s);
    const RollPitchYaw rotation = rotation_rms(r);
    result.rotation_ratio = {rotation.roll / baseline.rotation.roll,
                             rotation.pitch / baseline.rotation.pitch,
                             rotation.yaw / baseline.rotation.yaw};
    if (std::ranges::none_of(v.runs, [&](const auto& run) { return run.size() >= s.segment; }))
        return;
    result.spectrum = welch(v.runs, v.rate, {.segment = s.segment});
    result.power_ratio = band_power(result.spectrum, s.band_low, s.band_high) /
                         band_power(baseline.spectrum, s.band_low, s.band_high);
    result.entropy = spectral_entropy(result.spectrum, s.band_low, s.band_high);
}

void decide(SensorResult& result, const MonitorSettings& s) {
    if (!std::isfinite(result.outlier_share) || !std::isfinite(result.level_ratio)) {
        result.reason = "no point of the charts has a number";
        return;
    }
    const bool alarm = result.outlier_share > s.alarm_share;
    result.verdict = alarm ? Verdict::changed : Verdict::as_baseline;
    result.reason =
        fmt::format("{:.1f} % of {} points are outside the limits, {} {:g} %; root mean "
                    "square {:.2f} times that of the baseline",
                    100 * result.outlier_share, result.points.means.size(),
                    alarm ? "more than" : "at most", 100 * s.alarm_share, result.level_ratio);
}

/// Why the angular rates seem to be in another unit than in the baseline: while a train passes,
/// they are related to the accelerations; "".
std::string reason_against_units(const Recording& r, const SensorBaseline& baseline) {
    const double factor = rate_per_force(r) / baseline.rate_per_force; // NaN, infinite: unknown
    const auto is_near = [&](double expected) {
        return factor > expected / 1.5 && factor < expected * 1.5;
    };
    if (!is_near(180 / pi) && !is_near(pi / 180)) return {};
    return fmt::format("expected angular rates related to the accelerations as in the baseline, "
                       "found {:.3g} times as large: they seem to be in {}",
                       factor, factor > 1 ? "deg/s" : "rad/s, not in deg/s");
}

/// Compares a recording with its baseline.
void judge(SensorResult& result, const Recording& r, const SensorBaseline& baseline,
           const std::string& refusal, const MonitorSettings& s) {
    const Vibration v =
        refusal.empty() ? vibration_of(r, s.quantity, s.rest) : Vibration{.runs = {}};
    const Vibration train = passing_part(v, baseline.train_threshold);
    result.duration = v.duration;
    result.reason = reason_against(r, v, train, baseline, refusal, s);
    if (!result.reason.empty()) return;
    if (train.runs.empty()) {
        result.verdict = Verdict::no_train;
        result.reason = fmt::format("hardly any vibration: expected a root mean square of {:.3g} "
                                    "in some window of 0.25 s, found none",
                                    baseline.train_threshold);
        return;
    }
    result.reason = reason_against_units(r, baseline);
    if (!result.reason.empty()) return;
    compare(result, r, train, baseline, s);
    decide(result, s);
}

/// A sensor that lies still while another one moves is broken, or lost its contact.
void doubt_still_sensors(PassageResult& passage) {
    const bool train = std::ranges::any_of(passage.sensors, [](const SensorResult& s) {
        return s.verdict == Verdict::as_baseline || s.verdict == Verdict::changed;
    });
    if (!train) return;
    for (SensorResult& s : passage.sensors)
        if (s.verdict == Verdict::no_train) {
            s.verdict = Verdict::not_enough_data;
            s.reason += ", while other sensors moved";
        }
}

} // namespace

const char* text_of(Verdict verdict) {
    switch (verdict) {
    case Verdict::as_baseline:
        return "as the baseline";
    case Verdict::changed:
        return "changed";
    case Verdict::no_train:
        return "no train";
    case Verdict::time_unknown:
        return "time unknown";
    case Verdict::not_enough_data:
        break;
    }
    return "not enough data";
}

PassageResult judge_passage(const Passage& passage, const std::vector<SensorBaseline>& baselines,
                            const MonitorSettings& settings) {
    PassageResult result{.name = passage.name, .findings = findings_of(passage, settings)};
    std::set<unsigned> ids;
    for (const SensorBaseline& b : baselines) ids.insert(b.id);
    for (const Recording& r : passage.recordings) ids.insert(r.info.id);
    for (const unsigned id : ids) {
        SensorResult& sensor = result.sensors.emplace_back();
        sensor.id = id;
        const auto baseline = std::ranges::find(baselines, id, &SensorBaseline::id);
        const auto recording =
            std::ranges::find(passage.recordings, id, [](const Recording& r) { return r.info.id; });
        if (baseline == baselines.end()) {
            sensor.reason = "no baseline: the baseline has no such sensor";
            continue;
        }
        if (recording == passage.recordings.end()) {
            sensor.reason = "no recording of this sensor";
            continue;
        }
        if (const auto recorded = passage.recorded.find(id); recorded != passage.recorded.end()) {
            if (recorded->second < all_recorded) {
                sensor.reason = fmt::format("expected at least {:g} % of the passage recorded, "
                                            "found {:.0f} %",
                                            100 * all_recorded, 100 * recorded->second);
                continue;
            }
            if (recording->size() == 0) {
                sensor.verdict = Verdict::no_train;
                sensor.reason = "hardly any vibration";
                continue;
            }
        }
        judge(sensor, *recording, *baseline, refusal_of(result.findings, id), settings);
    }
    doubt_still_sensors(result);
    return result;
}

namespace {

constexpr int rank_of(Verdict v) {
    return v == Verdict::changed           ? 4
           : v == Verdict::time_unknown    ? 3
           : v == Verdict::not_enough_data ? 2
           : v == Verdict::as_baseline     ? 1
                                           : 0;
}

bool is_more_serious(const SensorResult& a, const SensorResult& b) {
    if (rank_of(a.verdict) != rank_of(b.verdict)) return rank_of(a.verdict) > rank_of(b.verdict);
    return a.outlier_share > b.outlier_share;
}

} // namespace

Verdict verdict_on(const PassageResult& passage) {
    Verdict worst = passage.sensors.empty() ? Verdict::not_enough_data : Verdict::no_train;
    for (const SensorResult& s : passage.sensors)
        if (rank_of(s.verdict) > rank_of(worst)) worst = s.verdict;
    return worst;
}

void PassageTally::add(Verdict verdict, int count) {
    std::size_t& n = verdict == Verdict::as_baseline    ? as_baseline
                     : verdict == Verdict::changed      ? changed
                     : verdict == Verdict::no_train     ? no_train
                     : verdict == Verdict::time_unknown ? time_unknown
                                                        : not_enough_data;
    n = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(n) + count);
}

std::size_t PassageTally::all() const {
    return as_baseline + changed + no_train + not_enough_data + time_unknown;
}

std::string PassageTally::not_judged() const {
    std::string reasons;
    for (const auto& [count, verdict] : {std::pair{no_train, Verdict::no_train},
                                         {not_enough_data, Verdict::not_enough_data},
                                         {time_unknown, Verdict::time_unknown}})
        if (count > 0)
            reasons += fmt::format(
                "{}{}{}", reasons.empty() ? "" : ", ", text_of(verdict),
                all() - as_baseline - changed == count ? "" : fmt::format(" {}", count));
    if (reasons.empty()) return {};
    return fmt::format("{} not judged: {}", all() - as_baseline - changed, reasons);
}

std::string PassageTally::sentence() const {
    std::string text = fmt::format("as the baseline in {} of {} passages", as_baseline, all());
    if (changed > 0) text += fmt::format(", changed in {}", changed);
    const std::string others = not_judged();
    return others.empty() ? text : text + "; " + others;
}

MostSerious most_serious_result(const std::vector<PassageResult>& passages,
                                std::optional<unsigned> sensor) {
    MostSerious worst;
    for (const PassageResult& passage : passages)
        for (const SensorResult& one : passage.sensors)
            if ((!sensor || one.id == *sensor) &&
                (worst.sensor == nullptr || is_more_serious(one, *worst.sensor)))
                worst = {&passage, &one};
    return worst;
}

OverallVerdict overall_verdict(const std::vector<PassageResult>& passages,
                               std::optional<unsigned> sensor) {
    const MostSerious worst = most_serious_result(passages, sensor);
    if (worst.sensor == nullptr) return {Verdict::not_enough_data, "nothing was recorded"};
    const Verdict verdict = worst.sensor->verdict;
    if (verdict == Verdict::as_baseline && !sensor)
        return {verdict, "every sensor in every passage is as its baseline"};
    return {verdict == Verdict::no_train ? Verdict::not_enough_data : verdict,
            fmt::format("sensor {} in {}: {}", worst.sensor->id, worst.passage->name,
                        worst.sensor->reason)};
}

} // namespace bris

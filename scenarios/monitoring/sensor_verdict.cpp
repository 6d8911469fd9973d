#include "scenarios/monitoring/sensor_verdict.hpp"

#include "scenarios/monitoring/features.hpp"

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

/// Length (s) of the runs that are longer than the order of the model.
double usable_duration(const std::vector<std::vector<double>>& runs, double rate,
                       std::size_t order) {
    std::size_t samples = 0;
    for (const auto& run : runs)
        if (run.size() > order) samples += run.size();
    return static_cast<double>(samples) / rate;
}

/// Why nothing can be said of a recording; empty: something can.
/// `v`: the recording; `runs`: what of it is compared.
std::string reason_against(const Recording& r, const Vibration& v,
                           const std::vector<std::vector<double>>& runs,
                           const SensorBaseline& baseline, const std::string& refusal,
                           const MonitorSettings& s) {
    if (!baseline.impossible_because.empty()) return "no baseline: " + baseline.impossible_because;
    if (r.size() == 0) return "no samples";
    if (!refusal.empty()) return "refused by quality control: " + refusal;
    if (v.impossible_because.empty() && v.duration < s.least_duration)
        return fmt::format("too short: expected at least {:g} s, found {:.3g} s", s.least_duration,
                           v.duration);
    if (!v.impossible_because.empty()) return v.impossible_because;
    if (!is_same_rate(v.rate, baseline.rate))
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
    const double usable = usable_duration(runs, v.rate, baseline.model.order());
    if (!runs.empty() && usable < s.least_duration)
        return fmt::format("too short: expected at least {:g} s without gaps while a train passes, "
                           "found {:.3g} s",
                           s.least_duration, usable);
    return {};
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

/// What of one sensor's recording is compared.
struct Compared {
    const Recording* recording = nullptr; // null: it is not
    const SensorBaseline* baseline = nullptr;
    Vibration vibration = {};
    std::vector<SampleRange> ranges = {};
    std::vector<std::vector<double>> runs = {};
};

/// s, from the first to the last sample that is compared.
struct Interval {
    double begin = std::numeric_limits<double>::infinity(), end = -begin;
};

void select(Compared& c, std::vector<SampleRange> ranges) {
    c.ranges = std::move(ranges);
    c.runs = runs_in(c.vibration, c.ranges);
}

/// The whole ranges within an interval.
std::vector<SampleRange> ranges_in(const Compared& c, const Interval& interval) {
    std::vector<SampleRange> ranges;
    for (SampleRange range : whole_ranges(c.vibration)) {
        const auto& t = c.recording->time;
        while (range.begin < range.end && t[range.begin] < interval.begin) ++range.begin;
        while (range.begin < range.end && t[range.end - 1] > interval.end) --range.end;
        if (range.begin < range.end) ranges.push_back(range);
    }
    return ranges;
}

/// Expected and found features of a recording; those that need axes only if it was not turned.
void compare(SensorResult& result, const Compared& c, const PassageCause& cause, bool is_moved,
             const MonitorSettings& s) {
    auto values = features_of(*c.recording, c.vibration, c.ranges);
    add_model_features(values, c.baseline->model, c.runs, c.baseline->usual_samples());
    const auto expected = c.baseline->features.expected(cause);
    result.features.resize(values.size());
    for (std::size_t f = 0; f < values.size(); ++f) {
        JudgedFeature& judged = result.features[f];
        judged.expected = expected[f];
        if (!expected[f].is_known() || !std::isfinite(values[f]) ||
            (is_moved && all_features()[f].by_axis))
            continue;
        judged.difference = values[f] - expected[f].mean;
        judged.deviation = expected[f].deviation();
        const double t = judged.difference / judged.deviation;
        judged.p = p_of_deviation(all_features()[f].only_above ? std::max(0.0, t) : t,
                                  expected[f].degrees);
    }
    result.outlier_shares = c.baseline->report_rule.outlier_shares(c.runs);
    std::vector<double> begins;
    for (const SampleRange& range : c.ranges) begins.push_back(c.recording->time[range.begin]);
    result.points = c.baseline->report_rule.points(c.runs, c.vibration.rate, begins);
    if (std::ranges::any_of(c.runs, [&](const auto& run) { return run.size() >= s.segment; }))
        result.spectrum = welch(c.runs, c.vibration.rate, {.segment = s.segment});
}

/// Angle (rad) from which a sensor counts as turned.
double turned_from(const SensorBaseline& b) { return std::max(5 * pi / 180, 5 * b.tilt_scatter); }

bool is_judged(const JudgedFeature& f) { return std::isfinite(f.p); }

/// Marks the features that have changed, of all sensors of a passage together.
void find_changes(PassageResult& passage, double false_alarms) {
    std::size_t sensors = 0;
    for (const SensorResult& s : passage.sensors)
        sensors += std::ranges::any_of(s.features, is_judged);
    std::vector<double> p, shares;
    std::vector<JudgedFeature*> places;
    for (SensorResult& s : passage.sensors) {
        std::vector<bool> judged;
        for (const JudgedFeature& f : s.features) judged.push_back(is_judged(f));
        if (std::ranges::none_of(judged, [](bool one) { return one; })) continue;
        const auto own = shares_of(judged, sensors);
        for (std::size_t f = 0; f < s.features.size(); ++f) {
            JudgedFeature& feature = s.features[f];
            if (!judged[f]) continue;
            places.push_back(&feature);
            p.push_back(feature.p);
            shares.push_back(own[f]);
            feature.seen = seen_in_90_per_cent(feature.expected, false_alarms * own[f]);
        }
    }
    const auto is_changed = rejected(p, shares, false_alarms);
    for (std::size_t k = 0; k < places.size(); ++k) places[k]->is_changed = is_changed[k];
}

/// The changed features, the least probable first.
std::string changes_of(const SensorResult& s) {
    std::vector<std::size_t> changed;
    for (std::size_t f = 0; f < s.features.size(); ++f)
        if (s.features[f].is_changed) changed.push_back(f);
    std::ranges::sort(changed, {}, [&](std::size_t f) { return s.features[f].p; });
    std::string text;
    constexpr std::size_t most = 3;
    for (std::size_t k = 0; k < std::min(most, changed.size()); ++k)
        text +=
            fmt::format("{}{} (p = {:.1g})", k > 0 ? ", " : "",
                        change_text(all_features()[changed[k]], s.features[changed[k]].difference,
                                    s.features[changed[k]].deviation),
                        s.features[changed[k]].p);
    if (changed.size() > most) text += fmt::format(", and {} more", changed.size() - most);
    return text;
}

/// The kind of change: a level before a spectrum before a motion, then the least probable one.
Verdict kind_of_change(const SensorResult& s) {
    std::optional<std::size_t> first;
    const auto order = [&](std::size_t f) {
        return std::pair(all_features()[f].kind, s.features[f].p);
    };
    for (std::size_t f = 0; f < s.features.size(); ++f)
        if (s.features[f].is_changed && (!first || order(f) < order(*first))) first = f;
    return first ? verdict_of(all_features()[*first], s.features[*first].difference)
                 : Verdict::as_baseline;
}

/// Only levels along axes have changed, and no feature that a turn leaves as it is.
bool seems_turned(const SensorResult& s) {
    bool is_any = false;
    for (std::size_t f = 0; f < s.features.size(); ++f) {
        if (!s.features[f].is_changed) continue;
        const Feature& feature = all_features()[f];
        if (!feature.by_axis || feature.kind == FeatureKind::motion) return false;
        is_any = true;
    }
    return is_any;
}

/// "not judged, since it was not recorded: roll, pitch; "; empty: what the baseline has was judged.
std::string missing_in(const SensorResult& s) {
    std::string names;
    for (std::size_t f = 0; f < s.features.size(); ++f)
        if (s.features[f].expected.is_known() && !is_judged(s.features[f]))
            names += (names.empty() ? "" : ", ") + std::string(all_features()[f].meaning);
    return names.empty() ? "" : "not judged, since it was not recorded: " + names + "; ";
}

void decide(SensorResult& s, bool is_moved) {
    if (std::ranges::none_of(s.features, is_judged)) {
        s.reason = "no feature has a number";
        return;
    }
    const std::string changes = changes_of(s);
    if (is_moved) {
        s.verdict = Verdict::moved;
        s.reason = fmt::format(
            "it was turned by {:.0f} degrees or mounted anew; what does not depend on axes: {}",
            s.turned * 180 / pi, changes.empty() ? "as the baseline" : changes);
    } else if (changes.empty()) {
        s.verdict = Verdict::as_baseline;
        s.reason =
            fmt::format("{}vertical vibration {:.2f} times; below {:.2f} or above {:.2f} times "
                        "would have been seen in 90 % of passages",
                        missing_in(s), s.level_ratio(), s.seen_below(), s.seen_above());
    } else if (seems_turned(s)) {
        s.verdict = Verdict::moved;
        s.reason =
            "only the horizontal axes have changed, as if it was turned about the vertical: " +
            changes;
    } else {
        s.verdict = kind_of_change(s);
        s.reason = changes;
    }
}

/// Finds what of a recording is compared, or why nothing is.
Compared prepare(SensorResult& result, const Recording& r, const SensorBaseline& baseline,
                 const std::string& refusal, const MonitorSettings& s) {
    Compared c{&r, &baseline};
    c.vibration = refusal.empty() ? vibration_of(r, s.quantity, rest_of(s)) : Vibration{.runs = {}};
    result.duration = c.vibration.duration;
    select(c, s.every_one ? whole_ranges(c.vibration)
                          : active_ranges(c.vibration, baseline.train_threshold, s.train_level));
    result.reason = reason_against(r, c.vibration, c.runs, baseline, refusal, s);
    if (result.reason.empty() && !c.runs.empty()) result.reason = reason_against_units(r, baseline);
    if (!result.reason.empty()) c.recording = nullptr;
    return c;
}

/// Whether a sensor hardly moves, or did so in a stream, which then keeps none of its samples.
bool is_quiet(const SensorResult& sensor, const Compared& c) {
    return c.recording != nullptr ? c.ranges.empty()
                                  : sensor.verdict == Verdict::quieter_or_no_train;
}

/// What is compared of sensors that hardly move: the time in which others do.
void complete(PassageResult& passage, std::vector<Compared>& all, const MonitorSettings& s) {
    Interval train;
    for (const Compared& c : all)
        if (c.recording != nullptr && !c.ranges.empty()) {
            train.begin = std::min(train.begin, c.recording->time[c.ranges.front().begin]);
            train.end = std::max(train.end, c.recording->time[c.ranges.back().end - 1]);
        }
    const bool is_seen = train.begin < train.end;
    std::size_t quiet = 0; // sensors
    for (std::size_t k = 0; k < all.size(); ++k) quiet += is_quiet(passage.sensors[k], all[k]);
    for (std::size_t k = 0; k < all.size(); ++k) {
        Compared& c = all[k];
        SensorResult& sensor = passage.sensors[k];
        if (!is_quiet(sensor, c)) continue;
        sensor.verdict = is_seen     ? Verdict::not_enough_data
                         : quiet > 1 ? Verdict::no_train
                                     : Verdict::quieter_or_no_train;
        if (c.recording != nullptr && is_seen) {
            select(c, ranges_in(c, train));
            if (usable_duration(c.runs, c.vibration.rate, c.baseline->model.order()) >=
                s.least_duration)
                continue;
        }
        sensor.reason = std::string("hardly any vibration") +
                        (is_seen     ? ", while other sensors moved"
                         : quiet > 1 ? ""
                                     : "; no other sensor shows whether a train passed");
        c.recording = nullptr;
    }
}

/// Why a sensor's recording cannot be prepared; empty: it can.
std::string reason_against_passage(SensorResult& sensor, const Passage& passage,
                                   const SensorBaseline* baseline, const Recording* recording) {
    if (baseline == nullptr) return "no baseline: the baseline has no such sensor";
    if (recording == nullptr) return "no recording of this sensor";
    const auto recorded = passage.recorded.find(sensor.id);
    if (recorded == passage.recorded.end()) return {};
    if (recorded->second < all_recorded)
        return fmt::format("expected at least {:g} % of the passage recorded, found {:.0f} %",
                           100 * all_recorded, 100 * recorded->second);
    if (recording->size() > 0) return {};
    sensor.verdict = Verdict::quieter_or_no_train;
    return "hardly any vibration";
}

} // namespace

Verdict verdict_of(const Feature& feature, double difference) {
    return feature.kind == FeatureKind::level
               ? (difference > 0 ? Verdict::louder : Verdict::quieter)
           : feature.kind == FeatureKind::spectrum ? Verdict::another_spectrum
                                                   : Verdict::another_motion;
}

std::string change_text(const Feature& feature, double difference, double deviation) {
    return feature.factor == 0 ? fmt::format("{} {:+.1f} standard deviations", feature.meaning,
                                             difference / deviation)
                               : fmt::format("{} {:.2f} times", feature.meaning,
                                             std::exp(feature.factor * difference));
}

double SensorResult::level_ratio() const {
    return features.empty() ? unknown : std::exp(features.front().difference);
}
double SensorResult::seen_below() const {
    return features.empty() ? unknown : std::exp(-features.front().seen);
}
double SensorResult::seen_above() const {
    return features.empty() ? unknown : std::exp(features.front().seen);
}

PassageResult judge_passage(const Passage& passage, const std::vector<SensorBaseline>& baselines,
                            const MonitorSettings& settings) {
    PassageResult result{.name = passage.name, .findings = findings_of(passage, settings)};
    std::set<unsigned> ids;
    for (const SensorBaseline& b : baselines) ids.insert(b.id);
    for (const Recording& r : passage.recordings) ids.insert(r.info.id);
    std::vector<Compared> compared;
    for (const unsigned id : ids) {
        SensorResult& sensor = result.sensors.emplace_back();
        sensor.id = id;
        const auto b = std::ranges::find(baselines, id, &SensorBaseline::id);
        const auto r = std::ranges::find(passage.recordings, id,
                                         [](const Recording& one) { return one.info.id; });
        const SensorBaseline* baseline = b == baselines.end() ? nullptr : &*b;
        const Recording* recording = r == passage.recordings.end() ? nullptr : &*r;
        sensor.reason = reason_against_passage(sensor, passage, baseline, recording);
        compared.push_back(
            sensor.reason.empty()
                ? prepare(sensor, *recording, *baseline, refusal_of(result.findings, id), settings)
                : Compared{});
    }
    complete(result, compared, settings);
    std::vector<bool> is_moved(compared.size(), false);
    for (std::size_t k = 0; k < compared.size(); ++k) {
        const Compared& c = compared[k];
        SensorResult& sensor = result.sensors[k];
        if (c.recording == nullptr) continue;
        sensor.reason = c.baseline->features.impossible_because(passage.cause);
        if (!sensor.reason.empty()) continue;
        const Vec3 up = up_of(*c.recording);
        if (up.norm() > 0 && c.baseline->up.norm() > 0)
            sensor.turned = std::acos(std::clamp(up.dot(c.baseline->up), -1.0, 1.0));
        is_moved[k] = sensor.turned > turned_from(*c.baseline);
        compare(sensor, c, passage.cause, is_moved[k], settings);
    }
    find_changes(result, settings.false_alarms);
    for (std::size_t k = 0; k < compared.size(); ++k)
        if (!result.sensors[k].features.empty()) decide(result.sensors[k], is_moved[k]);
    return result;
}

namespace {

double least_p(const SensorResult& s) {
    double least = 2;
    for (const JudgedFeature& f : s.features)
        if (f.p < least) least = f.p;
    return least;
}

bool is_more_serious(const SensorResult& a, const SensorResult& b) {
    if (a.verdict != b.verdict) return a.verdict > b.verdict;
    return least_p(a) < least_p(b);
}

} // namespace

Verdict verdict_on(const PassageResult& passage) {
    Verdict worst = passage.sensors.empty() ? Verdict::not_enough_data : Verdict::no_train;
    for (const SensorResult& s : passage.sensors) worst = std::max(worst, s.verdict);
    return worst;
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

} // namespace bris

#include "scenarios/monitoring/site_verdict.hpp"

#include "scenarios/monitoring/features.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace bris {

namespace {

/// A hypothesis about a feature of a sensor: that its mean, its slope, the mean of the last
/// passages, or one passage is as the baseline. Each kind has a quarter of the false alarms.
struct Hypothesis {
    enum class Kind { mean, slope, recent, passage };
    Kind kind;
    std::size_t sensor, feature, passage = 0; ///< of recent: the first one
    double p, share;
    bool is_rejected = false;
};

/// The results of one sensor in those passages in which it was judged.
struct Course {
    std::vector<const PassageResult*> passages;
    std::vector<const SensorResult*> results;
    std::vector<Trend> trends;                                      // of each feature
    std::vector<std::vector<std::pair<std::size_t, Trend>>> recent; // from a passage on
};

/// What a one-sided feature shows below its mean is no change.
void ignore_below(Trend& trend) {
    if (trend.mean < 0) trend.p_mean = 1;
    if (trend.slope < 0) trend.p_slope = 1;
}

Course course_of(const std::vector<PassageResult>& passages, unsigned id,
                 const SensorBaseline* baseline) {
    Course course;
    for (const PassageResult& passage : passages)
        for (const SensorResult& s : passage.sensors)
            if (s.id == id && !s.features.empty()) {
                course.passages.push_back(&passage);
                course.results.push_back(&s);
            }
    if (course.results.empty() || baseline == nullptr) return course;
    for (std::size_t f = 0; f < all_features().size(); ++f) {
        std::vector<double> deviations;
        for (const SensorResult* s : course.results)
            deviations.push_back(s->features[f].difference /
                                 std::sqrt(s->features[f].expected.variance));
        const auto trend = [&](const std::vector<double>& of) {
            Trend found = trend_of(of, course.results.back()->features[f].expected,
                                   baseline->features.serial(), baseline->features.between());
            if (all_features()[f].only_above) ignore_below(found);
            return found;
        };
        course.trends.push_back(trend(deviations));
        auto& recent = course.recent.emplace_back();
        for (std::size_t last = 2; last < deviations.size(); last *= 2) {
            const std::size_t first = deviations.size() - last;
            recent.emplace_back(
                first,
                trend({deviations.begin() + static_cast<std::ptrdiff_t>(first), deviations.end()}));
        }
    }
    return course;
}

bool is_judged(const Course& course, std::size_t feature) {
    return std::ranges::any_of(course.results, [&](const SensorResult* s) {
        return std::isfinite(s->features[feature].p);
    });
}

void add_hypotheses(std::vector<Hypothesis>& all, const Course& course, std::size_t sensor,
                    std::size_t sensors) {
    using enum Hypothesis::Kind;
    std::vector<bool> judged;
    for (std::size_t f = 0; f < all_features().size(); ++f) judged.push_back(is_judged(course, f));
    const auto shares = shares_of(judged, sensors);
    for (std::size_t f = 0; f < judged.size(); ++f) {
        if (!judged[f]) continue;
        const Trend& trend = course.trends[f];
        const bool has_trend = trend.passages > 1;
        if (has_trend) {
            all.push_back({mean, sensor, f, 0, trend.p_mean, shares[f] / 4});
            all.push_back({slope, sensor, f, 0, trend.p_slope, shares[f] / 4});
        }
        for (const auto& [first, last] : course.recent[f])
            all.push_back({recent, sensor, f, first, last.p_mean,
                           shares[f] / 4 / static_cast<double>(course.recent[f].size())});
        const double each = (has_trend ? shares[f] / 4 : shares[f]) /
                            static_cast<double>(std::max<std::size_t>(1, trend.passages));
        for (std::size_t k = 0; k < course.results.size(); ++k)
            if (const double p = course.results[k]->features[f].p; std::isfinite(p))
                all.push_back({passage, sensor, f, k, p, each});
    }
}

/// A level tells more than a spectrum, and that more than a motion; then the less probable one.
bool tells_more(const Hypothesis& a, const Hypothesis& b) {
    const auto kind = [](const Hypothesis& h) { return all_features()[h.feature].kind; };
    if (kind(a) != kind(b)) return kind(a) < kind(b);
    return a.p / a.share < b.p / b.share;
}

std::string factor_text(double factor, double difference) {
    return fmt::format("{:.2f} times", std::exp(factor * difference));
}

/// The verdict by the least probable hypothesis that was rejected.
OverallVerdict verdict_by(const Hypothesis& h, const Course& course) {
    const Feature& feature = all_features()[h.feature];
    const Trend& trend = course.trends[h.feature];
    const SensorResult& last = *course.results.back();
    const double unit = std::sqrt(last.features[h.feature].expected.variance);
    const std::string p = fmt::format("(p = {:.1g})", h.p);
    const auto kind = [&](double difference) {
        return feature.kind == FeatureKind::level
                   ? (difference > 0 ? Verdict::louder : Verdict::quieter)
               : feature.kind == FeatureKind::spectrum ? Verdict::another_spectrum
                                                       : Verdict::another_motion;
    };
    if (h.kind == Hypothesis::Kind::passage) {
        const double difference = course.results[h.passage]->features[h.feature].difference;
        return {kind(difference),
                fmt::format("in {}: {} {} {}", course.passages[h.passage]->name, feature.meaning,
                            feature.factor == 0
                                ? fmt::format("{:+.1f} standard deviations", difference / unit)
                                : factor_text(feature.factor, difference),
                            p)};
    }
    if (h.kind == Hypothesis::Kind::recent && !trend.is_slope) {
        const auto found = std::ranges::find(course.recent[h.feature], h.passage,
                                             &std::pair<std::size_t, Trend>::first);
        const Trend& window = found->second;
        return {kind(window.mean),
                fmt::format("{} {} in the mean of the last {} of {} passages {}", feature.meaning,
                            feature.factor == 0
                                ? fmt::format("{:+.1f} standard deviations", window.mean)
                                : factor_text(feature.factor, window.mean * unit),
                            window.passages, trend.passages, p)};
    }
    if (trend.is_slope)
        return {Verdict::drifts,
                feature.factor == 0
                    ? fmt::format("{} {:+.2g} standard deviations a passage {}", feature.meaning,
                                  trend.slope, p)
                    : fmt::format("{} {:+.1f} % a passage {}", feature.meaning,
                                  100 * std::expm1(feature.factor * trend.slope * unit), p)};
    return {kind(trend.mean),
            fmt::format("{} {} in the mean of {} passages {}", feature.meaning,
                        feature.factor == 0 ? fmt::format("{:+.1f} standard deviations", trend.mean)
                                            : factor_text(feature.factor, trend.mean * unit),
                        trend.passages, p)};
}

/// Without a rejected hypothesis: the most serious of what was not judged, or an all-clear.
OverallVerdict verdict_without_change(const std::vector<PassageResult>& passages,
                                      const SensorSummary& s) {
    OverallVerdict worst{Verdict::no_train, "no train passed"};
    std::size_t alone = 0;
    for (const PassageResult& passage : passages)
        for (const SensorResult& one : passage.sensors) {
            if (one.id != s.id) continue;
            alone += is_change(one.verdict);
            if (is_change(one.verdict) || one.verdict <= worst.verdict) continue;
            worst = {one.verdict, fmt::format("in {}: {}", passage.name, one.reason)};
        }
    if (worst.verdict == Verdict::no_train && alone == 0) return worst;
    if (alone > 1 && 3 * alone > s.judged) { // more than chance can explain
        const MostSerious most = most_serious_result(passages, s.id);
        return {most.sensor->verdict,
                fmt::format("in {} of {} passages, as in {}: {}", alone, s.judged,
                            most.passage->name, most.sensor->reason)};
    }
    if (worst.verdict > Verdict::as_baseline) return worst;
    std::string text = fmt::format(
        "vertical vibration {:.2f} times in {} {}; below {:.2f} or above {:.2f} times would have "
        "been seen in 90 % of such runs",
        s.level_ratio, s.judged, s.judged == 1 ? "passage" : "passages", s.seen_below,
        s.seen_above);
    if (alone > 0) text += fmt::format("; {} differed by itself, which chance explains", alone);
    return {Verdict::as_baseline, text};
}

/// What the levels say, and which lasting change of the level would have been seen.
void add_level(SensorSummary& s, const Course& course, std::size_t sensors, double false_alarms) {
    s.judged = course.results.size();
    if (!is_judged(course, 0)) return;
    const ExpectedFeature& expected = course.results.back()->features.front().expected;
    std::vector<bool> judged;
    for (std::size_t f = 0; f < all_features().size(); ++f) judged.push_back(is_judged(course, f));
    const double share = shares_of(judged, sensors).front(), unit = std::sqrt(expected.variance);
    s.level = course.trends.front();
    ExpectedFeature of_run = expected;
    if (s.level.passages < 2) {
        const SensorResult& only = *course.results.back();
        s.level.mean = only.features.front().difference / unit;
    } else {
        of_run.variance *= s.level.variance;
        of_run.of_mean *= expected.variance / of_run.variance;
        s.change_a_passage = std::expm1(s.level.slope * unit);
    }
    s.level_ratio = std::exp(s.level.mean * unit);
    const double seen =
        seen_in_90_per_cent(of_run, false_alarms * share * (s.level.passages < 2 ? 1 : 1.0 / 4));
    s.seen_below = std::exp(-seen);
    s.seen_above = std::exp(seen);
}

} // namespace

std::vector<SensorSummary> judge_together(const std::vector<PassageResult>& passages,
                                          const std::vector<SensorBaseline>& baselines,
                                          double false_alarms) {
    std::set<unsigned> ids;
    for (const PassageResult& passage : passages)
        for (const SensorResult& s : passage.sensors) ids.insert(s.id);
    std::vector<SensorSummary> sensors;
    std::vector<Course> courses;
    std::vector<const SensorBaseline*> of;
    std::size_t judged = 0;
    for (const unsigned id : ids) {
        const auto baseline = std::ranges::find(baselines, id, &SensorBaseline::id);
        of.push_back(baseline == baselines.end() ? nullptr : &*baseline);
        sensors.push_back({.id = id});
        courses.push_back(course_of(passages, id, of.back()));
        judged += !courses.back().results.empty();
    }
    std::vector<Hypothesis> all;
    for (std::size_t k = 0; k < sensors.size(); ++k) {
        if (courses[k].results.empty()) continue;
        add_level(sensors[k], courses[k], judged, false_alarms);
        add_hypotheses(all, courses[k], k, judged);
    }
    std::vector<double> p, shares;
    for (const Hypothesis& h : all) {
        p.push_back(h.p);
        shares.push_back(h.share);
    }
    const auto is_rejected = rejected(p, shares, false_alarms);
    std::vector<const Hypothesis*> worst(sensors.size(), nullptr);
    for (std::size_t k = 0; k < all.size(); ++k)
        if (is_rejected[k] &&
            (worst[all[k].sensor] == nullptr || tells_more(all[k], *worst[all[k].sensor])))
            worst[all[k].sensor] = &all[k];
    for (std::size_t k = 0; k < sensors.size(); ++k) {
        const auto moved = std::ranges::find(courses[k].results, Verdict::moved,
                                             [](const SensorResult* one) { return one->verdict; });
        const bool is_moved = moved != courses[k].results.end();
        if (worst[k] == nullptr || (is_moved && all_features()[worst[k]->feature].by_axis)) {
            sensors[k].overall = verdict_without_change(passages, sensors[k]);
            continue;
        }
        sensors[k].overall = verdict_by(*worst[k], courses[k]);
        if (!is_moved) continue;
        const auto place = static_cast<std::size_t>(moved - courses[k].results.begin());
        sensors[k].overall.reason +=
            fmt::format("; it was also moved, first in {}", courses[k].passages[place]->name);
    }
    return sensors;
}

OverallVerdict overall_verdict(const std::vector<SensorSummary>& sensors) {
    if (sensors.empty()) return {Verdict::not_enough_data, "nothing was recorded"};
    const auto worst = std::ranges::max_element(
        sensors, {}, [](const SensorSummary& s) { return s.overall.verdict; });
    if (worst->overall.verdict == Verdict::as_baseline)
        return {Verdict::as_baseline, "every sensor in every passage is as its baseline"};
    const Verdict verdict = worst->overall.verdict == Verdict::no_train ? Verdict::not_enough_data
                                                                        : worst->overall.verdict;
    return {verdict, fmt::format("sensor {}: {}", worst->id, worst->overall.reason)};
}

} // namespace bris

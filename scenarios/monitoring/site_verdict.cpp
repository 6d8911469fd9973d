#include "scenarios/monitoring/site_verdict.hpp"

#include "scenarios/monitoring/features.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace bris {

namespace {

/// A test of a feature of a sensor: that it is as the baseline.
struct Hypothesis {
    std::size_t sensor, feature;
    TestOfRun test;
};

/// The results of one sensor in those passages in which it was judged.
struct Course {
    std::vector<const PassageResult*> passages;
    std::vector<const SensorResult*> results;
    std::vector<bool> is_judged; // of each feature: in some passage

    /// What is expected of a feature, as in the last passage.
    const ExpectedFeature& expected(std::size_t feature) const {
        return results.back()->features[feature].expected;
    }
    /// Deviations of a feature in standard deviations of a passage.
    std::vector<double> deviations(std::size_t feature) const {
        std::vector<double> all;
        for (const SensorResult* s : results)
            all.push_back(s->features[feature].difference /
                          std::sqrt(s->features[feature].expected.variance));
        return all;
    }
    std::vector<double> p(std::size_t feature) const {
        std::vector<double> all;
        for (const SensorResult* s : results) all.push_back(s->features[feature].p);
        return all;
    }
    Trend trend(std::size_t feature, const SensorBaseline& baseline) const {
        return trend_of(deviations(feature), expected(feature), baseline.features.serial(),
                        baseline.features.between());
    }
};

Course course_of(const std::vector<PassageResult>& passages, unsigned id) {
    Course course;
    for (const PassageResult& passage : passages)
        for (const SensorResult& s : passage.sensors)
            if (s.id == id && !s.features.empty()) {
                course.passages.push_back(&passage);
                course.results.push_back(&s);
            }
    if (course.results.empty()) return course;
    for (std::size_t f = 0; f < all_features().size(); ++f)
        course.is_judged.push_back(
            std::ranges::any_of(course.p(f), [](double p) { return std::isfinite(p); }));
    return course;
}

void add_hypotheses(std::vector<Hypothesis>& all, const Course& course,
                    const SensorBaseline& baseline, std::size_t sensor, std::size_t sensors) {
    const auto shares = shares_of(course.is_judged, sensors);
    for (std::size_t f = 0; f < shares.size(); ++f) {
        if (!course.is_judged[f]) continue;
        for (TestOfRun& test : tests_of_run(course.deviations(f), course.p(f), course.expected(f),
                                            baseline.features.serial(), baseline.features.between(),
                                            all_features()[f].only_above, shares[f]))
            all.push_back({sensor, f, std::move(test)});
    }
}

/// A level tells more than a spectrum, and that more than a motion; then the less probable one.
bool tells_more(const Hypothesis& a, const Hypothesis& b) {
    const auto kind = [](const Hypothesis& h) { return all_features()[h.feature].kind; };
    if (kind(a) != kind(b)) return kind(a) < kind(b);
    return a.test.p / a.test.share < b.test.p / b.test.share;
}

/// The verdict by the hypothesis that tells most of those that were rejected.
OverallVerdict verdict_by(const Hypothesis& h, const Course& course,
                          const SensorBaseline& baseline) {
    using enum TestOfRun::Kind;
    const Feature& feature = all_features()[h.feature];
    const double unit = std::sqrt(course.expected(h.feature).variance);
    const std::string p = fmt::format("(p = {:.1g})", h.test.p);
    if (h.test.kind == passage) {
        const double difference = course.results[h.test.passage]->features[h.feature].difference;
        return {verdict_of(feature, difference),
                fmt::format("in {}: {} {}", course.passages[h.test.passage]->name,
                            change_text(feature, difference, unit), p)};
    }
    const Trend trend = course.trend(h.feature, baseline);
    if (trend.is_slope)
        return {Verdict::drifts,
                feature.factor == 0
                    ? fmt::format("{} {:+.2g} standard deviations a passage {}", feature.meaning,
                                  trend.slope, p)
                    : fmt::format("{} {:+.1f} % a passage {}", feature.meaning,
                                  100 * std::expm1(feature.factor * trend.slope * unit), p)};
    const Trend& tested = h.test.kind == recent ? h.test.trend : trend;
    const std::string which = h.test.kind == recent
                                  ? fmt::format("last {} of {}", tested.passages, trend.passages)
                                  : fmt::format("{}", trend.passages);
    return {verdict_of(feature, tested.mean),
            fmt::format("{} in the mean of {}{} passages {}",
                        change_text(feature, tested.mean * unit, unit),
                        h.test.kind == recent ? "the " : "", which, p)};
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
void add_level(SensorSummary& s, const Course& course, const SensorBaseline& baseline,
               std::size_t sensors, double false_alarms) {
    s.judged = course.results.size();
    if (!course.is_judged.front()) return;
    const ExpectedFeature& expected = course.expected(0);
    const double share = shares_of(course.is_judged, sensors).front(),
                 unit = std::sqrt(expected.variance);
    s.level = course.trend(0, baseline);
    ExpectedFeature of_run = expected;
    const bool is_one = s.level.passages < 2;
    if (is_one) {
        s.level.mean = course.results.back()->features.front().difference / unit;
    } else {
        of_run.variance *= s.level.variance;
        of_run.of_mean *= expected.variance / of_run.variance;
        s.change_a_passage = std::expm1(s.level.slope * unit);
    }
    s.level_ratio = std::exp(s.level.mean * unit);
    const double seen = seen_in_90_per_cent(of_run, false_alarms * share * (is_one ? 1 : 1.0 / 4));
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
        courses.push_back(course_of(passages, id));
        judged += !courses.back().results.empty();
    }
    std::vector<Hypothesis> all;
    for (std::size_t k = 0; k < sensors.size(); ++k) {
        if (courses[k].results.empty()) continue;
        add_level(sensors[k], courses[k], *of[k], judged, false_alarms);
        add_hypotheses(all, courses[k], *of[k], k, judged);
    }
    std::vector<double> p, shares;
    for (const Hypothesis& h : all) {
        p.push_back(h.test.p);
        shares.push_back(h.test.share);
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
        sensors[k].overall = verdict_by(*worst[k], courses[k], *of[k]);
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

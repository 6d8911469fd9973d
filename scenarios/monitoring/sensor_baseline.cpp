#include "scenarios/monitoring/sensor_baseline.hpp"

#include "engine/errors.hpp"
#include "engine/running_hash.hpp"
#include "engine/signal/median.hpp"
#include "scenarios/monitoring/features.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <set>

namespace bris {

namespace {

/// What the passages that can be used contribute to the baseline of one sensor.
struct Collected {
    struct Usable {
        Vibration vibration;
        PassageCause cause;
        std::vector<SampleRange> ranges = {};
        std::vector<std::vector<double>> runs = {};
        std::vector<double> features = {}; // those without a model
        Recording recording = {};          // until its features are known
    };
    std::vector<Usable> passages;
    std::vector<Beginnings> recorded;
    std::vector<double> rates_per_force;
    std::vector<Vec3> ups;
    double rate = 0; // Hz
    std::size_t left_out = 0;
    std::string refused_because;
    std::vector<FeatureRow> rows;
};

void leave_out(Collected& all, const std::string& reason) {
    ++all.left_out;
    if (all.refused_because.empty()) all.refused_because = reason;
}

void collect(Collected& all, const Recording& r, const PassageCause& cause,
             const std::string& refusal, const MonitorSettings& settings) {
    Vibration v = refusal.empty() ? vibration_of(r, settings.quantity, rest_of(settings))
                                  : Vibration{.impossible_because = refusal};
    std::string reason = v.impossible_because;
    if (reason.empty() && v.missing > settings.largest_missing)
        reason = fmt::format("{:.1f} % of the samples are missing", 100 * v.missing);
    if (reason.empty() && v.saturated > settings.largest_saturated)
        reason = fmt::format("{:.2f} % of the samples are saturated", 100 * v.saturated);
    if (reason.empty() && !all.recorded.empty() && !is_same_rate(all.rate, r.info.sampling_rate))
        reason = "its passages have different sampling rates";
    if (!reason.empty()) {
        leave_out(all, reason);
        return;
    }
    if (all.recorded.empty()) all.rate = r.info.sampling_rate;
    all.recorded.emplace_back(r);
    if (const double quotient = rate_per_force(r); std::isfinite(quotient))
        all.rates_per_force.push_back(quotient);
    if (const Vec3 up = up_of(r); up.norm() > 0) all.ups.push_back(up);
    all.passages.push_back({.vibration = std::move(v), .cause = cause, .recording = r});
}

double mean_square(const std::vector<std::vector<double>>& runs) {
    double squares = 0, n = 0;
    for (const auto& run : runs)
        for (const double x : run) squares += x * x, ++n;
    return n > 0 ? squares / n : 0;
}

/// What of each passage is compared, and the threshold and level of the baseline.
void find_ranges(SensorBaseline& b, Collected& all, const MonitorSettings& settings) {
    double squares = 0;
    for (const auto& p : all.passages) squares += p.vibration.rms * p.vibration.rms;
    b.train_threshold =
        settings.train_level * std::sqrt(squares / static_cast<double>(all.passages.size()));
    std::vector<std::vector<double>> runs;
    for (auto& p : all.passages) {
        p.ranges = settings.every_one
                       ? whole_ranges(p.vibration)
                       : active_ranges(p.vibration, b.train_threshold, settings.train_level);
        p.runs = runs_in(p.vibration, p.ranges);
        p.features = features_of(p.recording, p.vibration, p.ranges);
        p.recording = {};
        for (const auto& run : p.runs) {
            b.samples += run.size();
            runs.push_back(run);
        }
    }
    b.rms = std::sqrt(mean_square(runs));
}

std::vector<ArModel> models_of(const std::vector<std::vector<double>>& runs,
                               const MonitorSettings& s, std::size_t largest) {
    return s.method == ArMethod::burg ? burg(runs, largest) : yule_walker(runs, largest);
}

/// Adds the features by models of which a passage is no part, as a new one is none.
void add_features_by_others(Collected& all, std::size_t order, double usual,
                            const MonitorSettings& settings) {
    constexpr std::size_t parts = 5;
    for (std::size_t part = 0; part < parts; ++part) {
        std::vector<std::vector<double>> others;
        for (std::size_t k = 0; k < all.passages.size(); ++k)
            if (k % parts != part)
                others.insert(others.end(), all.passages[k].runs.begin(),
                              all.passages[k].runs.end());
        if (std::ranges::none_of(others, [&](const auto& run) { return run.size() > order; }))
            continue;
        const ArModel model = models_of(others, settings, order).back();
        for (std::size_t k = part; k < all.passages.size(); k += parts)
            add_model_features(all.passages[k].features, model, all.passages[k].runs, usual);
    }
}

/// Leaves out passages without a feature, or a number of the cause, that three quarters have: one
/// of them would switch it off for all.
void leave_out_odd(Collected& all) {
    const auto leave_out_without = [&](auto&& has) {
        const auto with = static_cast<std::size_t>(std::ranges::count_if(all.rows, has));
        if (4 * with < 3 * all.rows.size() || with < least_passages) return;
        for (std::size_t k = with; k < all.rows.size(); ++k)
            leave_out(all, "something that the others have was not recorded, or not stated");
        std::erase_if(all.rows, [&](const FeatureRow& row) { return !has(row); });
    };
    for (std::size_t f = 0; f < all_features().size(); ++f)
        leave_out_without([&](const FeatureRow& row) { return std::isfinite(row.values[f]); });
    std::set<std::string> names;
    for (const FeatureRow& row : all.rows)
        for (const auto& [name, value] : row.cause.numbers) names.insert(name);
    for (const std::string& name : names)
        leave_out_without([&](const FeatureRow& row) { return row.cause.numbers.contains(name); });
}

void find_up(SensorBaseline& b, const std::vector<Vec3>& ups) {
    if (ups.empty()) return;
    for (const Vec3& up : ups) b.up += up;
    b.up.normalize();
    double squares = 0;
    for (const Vec3& up : ups)
        squares += std::pow(std::acos(std::clamp(up.dot(b.up), -1.0, 1.0)), 2);
    b.tilt_scatter = std::sqrt(squares / static_cast<double>(ups.size()));
}

void estimate(SensorBaseline& b, Collected& all, const MonitorSettings& settings) {
    b.rate = all.rate;
    b.recorded = all.recorded;
    if (!all.rates_per_force.empty()) b.rate_per_force = median(all.rates_per_force);
    find_up(b, all.ups);
    find_ranges(b, all, settings);
    std::vector<std::vector<double>> runs;
    std::vector<std::vector<std::vector<double>>> passages;
    for (const auto& p : all.passages) {
        runs.insert(runs.end(), p.runs.begin(), p.runs.end());
        if (!p.runs.empty()) passages.push_back(p.runs);
    }
    std::size_t longest = 0;
    for (const auto& run : runs) longest = std::max(longest, run.size());
    const double needed = std::max(settings.least_duration * b.rate,
                                   50.0 * settings.report_rule.subgroup + settings.largest_order);
    require(static_cast<double>(b.samples) >= needed && longest > settings.largest_order,
            fmt::format("expected at least {:.0f} samples while trains pass, found {}", needed,
                        b.samples));
    const auto models = models_of(runs, settings, settings.largest_order);
    b.orders = choose_order(models, b.samples);
    b.model = models[settings.criterion == OrderCriterion::bic ? b.orders.by_bic : b.orders.by_aic];
    add_features_by_others(all, b.model.order(), b.usual_samples(), settings);
    b.report_rule = ReportRule(b.model, passages, settings.report_rule);
    if (longest >= settings.segment)
        b.spectrum = welch(runs, b.rate, {.segment = settings.segment});
    for (auto& p : all.passages) {
        double seconds = 0;
        for (const auto& run : p.runs) seconds += static_cast<double>(run.size()) / b.rate;
        if (seconds < settings.least_duration)
            leave_out(all, fmt::format("{:.3g} s while a train passes", seconds));
        else
            all.rows.push_back({std::move(p.cause), std::move(p.features)});
    }
    leave_out_odd(all);
    b.left_out = all.left_out;
    b.left_out_because = all.refused_because;
}

} // namespace

double SensorBaseline::usual_samples() const {
    return static_cast<double>(samples) /
           static_cast<double>(std::max<std::size_t>(1, recorded.size()));
}

double rest_of(const MonitorSettings& settings) {
    constexpr double whole = 1e6; // s: without rest, the mean of all samples is the vertical
    return settings.every_one ? whole : settings.rest;
}

std::vector<Finding> findings_of(const Passage& passage, const MonitorSettings& settings) {
    QualityControlLimits limits;
    limits.rest = rest_of(settings);
    if (settings.every_one) limits.gravity = 0.3; // of a sensor that shakes; a wrong unit is 9.8
    auto findings = check_recordings(passage.recordings, Vec3(0, 0, -9.81), limits);
    for (Finding& f : findings) {
        // a sensor that was turned is found beside its baseline; one that is never at rest has
        // rates
        const bool is_no_fault = f.check == "frame" || (settings.every_one && f.check == "rate" &&
                                                        f.text.starts_with("at rest"));
        if (is_no_fault) f.kind = Finding::Kind::note;
    }
    return findings;
}

std::string refusal_of(const std::vector<Finding>& findings, unsigned sensor) {
    std::string text;
    for (const Finding& f : findings)
        if (f.sensor == sensor && f.kind == Finding::Kind::refusal)
            text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", f.check, f.text);
    return text;
}

Vec3 up_of(const Recording& r) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& f : r.force)
        if (f.allFinite()) sum += f;
    // what is measured without gravity has no direction
    const bool has_gravity =
        sum.norm() > 0.5 * standard_gravity * static_cast<double>(r.force.size());
    return has_gravity ? Vec3(sum.normalized()) : Vec3::Zero();
}

Beginnings::Beginnings(const Recording& recording) {
    const auto hashes_of = [](const std::vector<Vec3>& samples) {
        std::vector<std::uint64_t> found;
        std::uint64_t hash = 0;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            for (const double x : {samples[k].x(), samples[k].y(), samples[k].z()})
                hash = mix(hash, std::bit_cast<std::uint64_t>(x));
            if (std::has_single_bit(k + 1)) found.push_back(hash);
        }
        return found;
    };
    force = hashes_of(recording.force);
    rate = hashes_of(recording.rate);
}

bool Beginnings::are_those_of(const Beginnings& other) const {
    const auto alike = [](const auto& a, const auto& b) {
        const std::size_t n = std::min(a.size(), b.size());
        return n > 0 && a[n - 1] == b[n - 1];
    };
    return alike(force, other.force) || alike(rate, other.rate);
}

namespace {

using CollectedById = std::map<unsigned, Collected>;

void collect(CollectedById& by_id, const Passage& passage, const MonitorSettings& settings) {
    const auto findings = findings_of(passage, settings);
    for (const Recording& r : passage.recordings)
        collect(by_id[r.info.id], r, passage.cause, refusal_of(findings, r.info.id), settings);
}

std::vector<SensorBaseline> baselines_of(CollectedById& by_id, const MonitorSettings& settings) {
    std::vector<SensorBaseline> baselines;
    std::vector<std::vector<FeatureRow>> rows;
    for (auto& [id, all] : by_id) {
        SensorBaseline& b = baselines.emplace_back();
        b.id = id;
        b.impossible_because = all.refused_because.empty() ? "no samples" : all.refused_because;
        if (!all.recorded.empty()) {
            try {
                estimate(b, all, settings);
                b.impossible_because.clear();
            } catch (const InputError& e) {
                b.impossible_because = e.what();
            }
        }
        rows.push_back(std::move(all.rows));
    }
    std::vector<unsigned> families;
    for (const Feature& f : all_features()) families.push_back(f.family);
    auto models = site_models(rows, families);
    for (std::size_t k = 0; k < baselines.size(); ++k) baselines[k].features = std::move(models[k]);
    return baselines;
}

} // namespace

std::vector<SensorBaseline> baselines_of(const std::vector<Passage>& passages,
                                         const MonitorSettings& settings) {
    CollectedById by_id;
    for (const Passage& passage : passages) collect(by_id, passage, settings);
    return baselines_of(by_id, settings);
}

std::vector<SensorBaseline>
read_baselines(const std::function<void(const std::function<void(Passage&&)>&)>& for_each,
               const MonitorSettings& settings) {
    CollectedById by_id;
    for_each([&](const Passage& passage) { collect(by_id, passage, settings); });
    return baselines_of(by_id, settings);
}

} // namespace bris

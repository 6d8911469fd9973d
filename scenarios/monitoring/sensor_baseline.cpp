#include "scenarios/monitoring/sensor_baseline.hpp"

#include "engine/errors.hpp"
#include "engine/running_hash.hpp"
#include "engine/signal/median.hpp"
#include "scenarios/monitoring/vibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace bris {

namespace {

double squared(double x) { return x * x; }

/// What the passages that can be used contribute to the baseline of one sensor.
struct Collected {
    std::vector<Vibration> vibrations;
    std::vector<Beginnings> recorded;
    std::vector<double> rates_per_force;
    double rate = 0; // Hz
    RollPitchYaw rotation_squares;
    std::string refused_because;
};

void collect(Collected& all, const Recording& r, const std::string& refusal,
             const MonitorSettings& settings) {
    const Vibration v = refusal.empty() ? vibration_of(r, settings.quantity, settings.rest)
                                        : Vibration{.impossible_because = refusal};
    std::string reason = v.impossible_because;
    if (reason.empty() && v.missing > settings.largest_missing)
        reason = fmt::format("{:.1f} % of the samples are missing", 100 * v.missing);
    if (reason.empty() && v.saturated > settings.largest_saturated)
        reason = fmt::format("{:.2f} % of the samples are saturated", 100 * v.saturated);
    if (reason.empty() && !all.recorded.empty() && all.rate != r.info.sampling_rate)
        reason = "its passages have different sampling rates";
    if (!reason.empty()) {
        if (all.refused_because.empty()) all.refused_because = reason;
        return;
    }
    all.vibrations.push_back(v);
    all.recorded.emplace_back(r);
    all.rate = r.info.sampling_rate;
    if (const double quotient = rate_per_force(r); std::isfinite(quotient))
        all.rates_per_force.push_back(quotient);
    const RollPitchYaw rotation = rotation_rms(r);
    all.rotation_squares.roll += squared(rotation.roll);
    all.rotation_squares.pitch += squared(rotation.pitch);
    all.rotation_squares.yaw += squared(rotation.yaw);
}

std::vector<std::vector<double>> residuals_of_runs(const ArModel& model, Runs runs) {
    std::vector<std::vector<double>> residuals;
    for (const auto& run : runs) residuals.push_back(residuals_of(model, run));
    return residuals;
}

/// The runs of all passages while trains pass. Sets the threshold and the level of the baseline.
std::vector<std::vector<double>> passing_runs(SensorBaseline& b, const Collected& all,
                                              const MonitorSettings& settings) {
    double squares = 0;
    for (const Vibration& v : all.vibrations) squares += squared(v.rms);
    b.train_threshold = settings.train_level * std::sqrt(squares / static_cast<double>(b.passages));
    std::vector<std::vector<double>> runs;
    squares = 0;
    for (const Vibration& v : all.vibrations)
        for (auto& run : passing_part(v, b.train_threshold).runs) {
            for (const double x : run) squares += squared(x);
            b.samples += run.size();
            runs.push_back(std::move(run));
        }
    b.rms = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, b.samples)));
    return runs;
}

void estimate(SensorBaseline& b, const Collected& all, const MonitorSettings& settings) {
    b.passages = all.recorded.size();
    b.rate = all.rate;
    b.recorded = all.recorded;
    const double n = static_cast<double>(b.passages);
    b.rotation = {std::sqrt(all.rotation_squares.roll / n),
                  std::sqrt(all.rotation_squares.pitch / n),
                  std::sqrt(all.rotation_squares.yaw / n)};
    if (!all.rates_per_force.empty()) b.rate_per_force = median(all.rates_per_force);
    const auto runs = passing_runs(b, all, settings);
    std::size_t longest = 0;
    for (const auto& run : runs) longest = std::max(longest, run.size());
    const double needed = std::max(settings.least_duration * b.rate,
                                   50.0 * settings.subgroup + settings.largest_order);
    require(static_cast<double>(b.samples) >= needed && longest > settings.largest_order,
            fmt::format("expected at least {:.0f} samples while trains pass, found {}", needed,
                        b.samples));
    const auto models = settings.method == ArMethod::burg
                            ? burg(runs, settings.largest_order)
                            : yule_walker(runs, settings.largest_order);
    b.orders = choose_order(models, b.samples);
    b.model = models[settings.criterion == OrderCriterion::bic ? b.orders.by_bic : b.orders.by_aic];
    const auto residuals = residuals_of_runs(b.model, runs);
    b.means = mean_chart(residuals, settings.subgroup, settings.width, ControlLimits::corrected);
    b.deviations = deviation_chart(residuals, settings.subgroup, settings.width);
    b.spectrum = welch(runs, b.rate, {.segment = settings.segment});
    b.outlier_share = chart_points(b, runs, {}, settings).outlier_share(settings.width);
}

} // namespace

std::vector<Finding> findings_of(const Passage& passage, const MonitorSettings& settings) {
    QualityControlLimits limits;
    limits.rest = settings.rest;
    return check_recordings(passage.recordings, Vec3(0, 0, -9.81), limits);
}

std::string refusal_of(const std::vector<Finding>& findings, unsigned sensor) {
    std::string text;
    for (const Finding& f : findings)
        if (f.sensor == sensor && f.kind == Finding::Kind::refusal)
            text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", f.check, f.text);
    return text;
}

double ChartPoints::outlier_share(double width) const {
    if (means.empty()) return std::numeric_limits<double>::quiet_NaN();
    std::size_t outliers = 0;
    for (std::size_t k = 0; k < means.size(); ++k)
        outliers += !(std::abs(means[k]) <= width && std::abs(deviations[k]) <= width);
    return static_cast<double>(outliers) / static_cast<double>(means.size());
}

ChartPoints chart_points(const SensorBaseline& baseline, Runs runs,
                         const std::vector<double>& begins, const MonitorSettings& settings) {
    const auto residuals = residuals_of_runs(baseline.model, runs);
    const std::size_t n = settings.subgroup;
    ChartPoints points;
    for (const double mean : subgroup_means(residuals, n))
        points.means.push_back(baseline.means.standardised(mean));
    for (const double s : subgroup_deviations(residuals, n)) // a constant subgroup is an outlier
        points.deviations.push_back(baseline.deviations.standardised(std::log(s)));
    for (std::size_t r = 0; r < std::min(residuals.size(), begins.size()); ++r)
        for (std::size_t first = 0; first + n <= residuals[r].size(); first += n)
            points.times.push_back(begins[r] +
                                   (static_cast<double>(baseline.model.order() + first) +
                                    0.5 * static_cast<double>(n - 1)) /
                                       baseline.rate);
    return points;
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
        collect(by_id[r.info.id], r, refusal_of(findings, r.info.id), settings);
}

std::vector<SensorBaseline> baselines_of(const CollectedById& by_id,
                                         const MonitorSettings& settings) {
    std::vector<SensorBaseline> baselines;
    for (const auto& [id, all] : by_id) {
        SensorBaseline& b = baselines.emplace_back();
        b.id = id;
        b.impossible_because = all.refused_because.empty() ? "no samples" : all.refused_because;
        if (all.recorded.empty()) continue;
        try {
            estimate(b, all, settings);
            b.impossible_because.clear();
        } catch (const InputError& e) {
            b.impossible_because = e.what();
        }
    }
    return baselines;
}

} // namespace

std::vector<SensorBaseline> baselines_of(const std::vector<Passage>& passages,
                                         const MonitorSettings& settings) {
    CollectedById by_id;
    for (const Passage& passage : passages) collect(by_id, passage, settings);
    return baselines_of(by_id, settings);
}

std::vector<SensorBaseline> read_baselines(const std::filesystem::path& folder,
                                           const std::filesystem::path& columns,
                                           const std::string& option,
                                           const MonitorSettings& settings) {
    CollectedById by_id;
    for_each_passage(folder, columns, option,
                     [&](const Passage& passage) { collect(by_id, passage, settings); });
    return baselines_of(by_id, settings);
}

} // namespace bris

#include "systems/procedure/analysis.hpp"

#include "engine/errors.hpp"
#include "systems/fusion/parameter_estimate.hpp"
#include "systems/procedure/triaxial_results.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace bris {

namespace {

using Motions = std::vector<std::vector<Vec3>> ModelRun::*; // displacement or rotation

/// What the worlds leave beyond their regression at one stage: worlds x (3 rocks).
Matrix left_at(const Worlds& worlds, const Matrix& leaves, Motions motion, std::size_t stage) {
    const auto n = static_cast<Eigen::Index>(worlds.runs.size());
    const auto rocks = static_cast<Eigen::Index>(worlds.runs.front().rocks.size());
    Matrix all(n, 3 * rocks);
    for (Eigen::Index j = 0; j < n; ++j)
        for (Eigen::Index r = 0; r < rocks; ++r)
            for (Eigen::Index c = 0; c < 3; ++c)
                all(j, 3 * r + c) = (worlds.runs[static_cast<std::size_t>(j)].*motion)[stage][static_cast<std::size_t>(r)][c];
    return leaves * all;
}

constexpr double most_alike = 0.95; // of two rocks

/// Likeness over distance, from all pairs of rocks at some stages: sums in bins, then a line through the logarithms.
Likeness likeness_of(const Worlds& worlds, const Matrix& leaves, Motions motion, const std::vector<std::size_t>& stages) {
    const ModelRun& like = worlds.runs.front();
    const std::size_t rocks = like.rocks.size();
    double reach = 0;
    for (const RockPose& p : like.start) reach = std::max(reach, (p.position - like.start.front().position).norm());
    constexpr std::size_t bins = 24;
    std::array<double, bins> products{}, count{}, distance{};
    for (const std::size_t stage : stages) {
        const Matrix left = left_at(worlds, leaves, motion, stage);
        const double scale = left.squaredNorm() / static_cast<double>(rocks);
        if (!(scale > 0)) continue;
        for (std::size_t a = 0; a < rocks; ++a)
            for (std::size_t b = a + 1; b < rocks; ++b) {
                const double d = (like.start[a].position - like.start[b].position).norm();
                const auto bin = static_cast<std::size_t>(2 * bins * d / reach); // of half the reach
                if (bin >= bins) continue;
                const auto ca = static_cast<Eigen::Index>(3 * a), cb = static_cast<Eigen::Index>(3 * b);
                products[bin] += left.middleCols<3>(ca).cwiseProduct(left.middleCols<3>(cb)).sum() / scale;
                distance[bin] += d;
                ++count[bin];
            }
    }
    // weighted line: log likeness = log near - distance / length, as far as it is above a twentieth
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t k = 0; k < bins; ++k) {
        if (count[k] < 1) continue;
        const double d = distance[k] / count[k], value = std::min(products[k] / count[k], most_alike);
        if (value < 0.05) break;
        const double w = count[k] * value * value;
        n += w;
        x += w * d;
        y += w * std::log(value);
        xx += w * d * d;
        xy += w * d * std::log(value);
    }
    const bool one_distance = !(n * xx - x * x > 1e-9 * n * xx); // then the line begins at perfect likeness
    const double slope = one_distance ? xy / xx : (n * xy - x * y) / (n * xx - x * x);
    if (!(slope < 0)) return {};
    return {std::min(std::exp((y - slope * x) / n), most_alike), -1 / slope};
}

constexpr double gate = 4; // deviations, in each direction

/// Gross errors stand alone: what is far from the forecast but like the sample before is a rock that went its own way.
bool is_gross(const Vec3& off, const std::optional<Vec3>& off_before, double deviation) {
    if (off.squaredNorm() <= 3 * gate * gate * deviation * deviation) return false;
    return !off_before || (off - *off_before).squaredNorm() > 0.25 * off.squaredNorm();
}

/// What the last sample of each sensor up to a strain was off by; nothing: none yet, or refused.
std::vector<std::optional<Vec3>> innovations_at(const std::vector<SensorWay>& ways, std::vector<Vec3> SensorWay::* channel, const ModelRun& forecast, Motions motion,
                                                const std::vector<std::size_t>& hosts, double strain, double deviation) {
    std::vector<std::optional<Vec3>> innovations(ways.size());
    for (std::size_t s = 0; s < ways.size(); ++s) {
        const auto off_by = [&](std::ptrdiff_t k) -> std::optional<Vec3> {
            if (k < 0) return {};
            const auto sample = static_cast<std::size_t>(k);
            const auto stage = stage_of_sample(forecast, ways[s].strain[sample]);
            if (!stage || !(ways[s].*channel)[sample].allFinite()) return {};
            return Vec3((ways[s].*channel)[sample] - (forecast.*motion)[*stage][hosts[s]]);
        };
        const auto after = std::upper_bound(ways[s].strain.begin(), ways[s].strain.end(), strain + 1e-9);
        for (auto k = after - ways[s].strain.begin() - 1; k >= 0 && !innovations[s]; --k) { // one that was refused leaves the one before
            const auto off = off_by(k);
            if (off && !is_gross(*off, off_by(k - 1), deviation)) innovations[s] = off;
        }
    }
    return innovations;
}

/// Innovations of the sensors at one stage, carried to all rocks.
void carry(ModelRun& run, Motions motion, std::size_t stage, const std::vector<std::size_t>& hosts, const std::vector<std::optional<Vec3>>& innovations,
           const Likeness& likeness, double variance, double noise) {
    std::vector<std::size_t> heard;
    for (std::size_t s = 0; s < innovations.size(); ++s)
        if (innovations[s]) heard.push_back(s);
    const auto m = static_cast<Eigen::Index>(heard.size());
    if (m == 0 || !(variance > 0)) return;
    const auto place = [&](std::size_t rock) -> const Vec3& { return run.start[rock].position; };
    const auto host = [&](Eigen::Index i) -> const Vec3& { return place(hosts[heard[static_cast<std::size_t>(i)]]); };
    Matrix alike(m, m), innovation(m, 3);
    for (Eigen::Index i = 0; i < m; ++i) {
        innovation.row(i) = innovations[heard[static_cast<std::size_t>(i)]]->transpose();
        for (Eigen::Index j = 0; j < m; ++j) alike(i, j) = likeness((host(i) - host(j)).norm());
        alike(i, i) += noise * noise / variance;
    }
    const Matrix weights = alike.ldlt().solve(innovation);
    for (std::size_t rock = 0; rock < run.rocks.size(); ++rock)
        for (Eigen::Index i = 0; i < m; ++i) {
            const double share = likeness((place(rock) - host(i)).norm());
            (run.*motion)[stage][rock] += share * weights.row(i).transpose();
        }
}

} // namespace

RockScatter scatter_of(const Worlds& worlds) {
    require(!worlds.runs.empty(), "analysis: expected worlds, found none");
    const Matrix leaves = WorldRegression(logarithms_of(worlds.beliefs)).leaves();
    const ModelRun& like = worlds.runs.front();
    const std::size_t end = like.points.size();
    const auto freedom = static_cast<double>(worlds.beliefs.size() - 3), rocks = static_cast<double>(like.rocks.size());
    std::vector<std::size_t> some;
    for (std::size_t k = 1; k <= 10; ++k) some.push_back(k * (end - 1) / 10);
    const auto variance_of = [&](Motions motion) {
        std::vector<double> variance(end, 0);
        for (std::size_t stage = 1; stage < end; ++stage) variance[stage] = left_at(worlds, leaves, motion, stage).squaredNorm() / (freedom * 3 * rocks);
        return variance;
    };
    return {likeness_of(worlds, leaves, &ModelRun::displacement, some), likeness_of(worlds, leaves, &ModelRun::rotation, some),
            variance_of(&ModelRun::displacement), variance_of(&ModelRun::rotation)};
}

void analyse_stage(ModelRun& run, const ModelRun& forecast, const RockScatter& scatter, const SensorsHeard& sensors, std::size_t stage) {
    require(sensors.hosts.size() == sensors.ways.size(), "analysis: expected a way for each host");
    const double come = run.points[stage].axial_strain - sensors.lateness;
    const auto correct = [&](Motions motion, std::vector<Vec3> SensorWay::* channel, const Likeness& likeness, double variance, double noise) {
        // innovations are held from one sample to the next
        const auto innovations = innovations_at(sensors.ways, channel, forecast, motion, sensors.hosts, come, std::sqrt(variance + noise * noise));
        carry(run, motion, stage, sensors.hosts, innovations, likeness, variance, noise);
    };
    correct(&ModelRun::displacement, &SensorWay::displacement, scatter.displacement, scatter.displacement_variance[stage], sensors.position_noise);
    correct(&ModelRun::rotation, &SensorWay::rotation, scatter.rotation, scatter.rotation_variance[stage], sensors.attitude_noise);
}

ModelRun analyse(const ModelRun& forecast, const RockScatter& scatter, const SensorsHeard& sensors) {
    ModelRun run = forecast;
    for (std::size_t stage = 1; stage < std::min(forecast.points.size(), scatter.displacement_variance.size()); ++stage) analyse_stage(run, forecast, scatter, sensors, stage);
    return run;
}

} // namespace bris

#include "scenarios/assimilation/analysis.hpp"

#include "engine/errors.hpp"
#include "engine/estimation/chi_squared.hpp"
#include "engine/estimation/moderated_variance.hpp"
#include "engine/estimation/parameter_estimate.hpp"
#include "engine/signal/attitude.hpp"
#include "engine/signal/median.hpp"
#include "scenarios/triaxial/triaxial_results.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

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
                all(j, 3 * r + c) = (worlds.runs[static_cast<std::size_t>(j)].*
                                     motion)[stage][static_cast<std::size_t>(r)][c];
    return leaves * all;
}

constexpr double most_alike = 0.95; // of two rocks

/// Of one direction, of each rock: worlds are few, so rocks tell of each other.
std::vector<double> deviations_of(const Matrix& left, double freedom) {
    std::vector<double> deviations(static_cast<std::size_t>(left.cols() / 3));
    for (std::size_t r = 0; r < deviations.size(); ++r)
        deviations[r] =
            left.middleCols<3>(static_cast<Eigen::Index>(3 * r)).squaredNorm() / (3 * freedom);
    deviations = moderated_variances(std::move(deviations), 3 * freedom);
    for (double& d : deviations) d = std::sqrt(d);
    return deviations;
}

/// All pairs of rocks at one stage.
void add_pairs(LikenessSums& sums, const ModelRun& like, Matrix left,
               const std::vector<double>& deviation) {
    const std::size_t rocks = like.rocks.size();
    double reach = 0;
    for (const RockPose& p : like.start)
        reach = std::max(reach, (p.position - like.start.front().position).norm());
    for (std::size_t r = 0; r < rocks; ++r)
        left.middleCols<3>(static_cast<Eigen::Index>(3 * r)) /=
            std::max(deviation[r], std::numeric_limits<double>::min());
    const double scale = left.squaredNorm() / static_cast<double>(rocks);
    if (!(scale > 0)) return;
    for (std::size_t a = 0; a < rocks; ++a)
        for (std::size_t b = a + 1; b < rocks; ++b) {
            const double d = (like.start[a].position - like.start[b].position).norm();
            const auto bin =
                static_cast<std::size_t>(2 * LikenessSums::bins * d / reach); // of half the reach
            if (bin >= LikenessSums::bins) continue;
            const auto ca = static_cast<Eigen::Index>(3 * a), cb = static_cast<Eigen::Index>(3 * b);
            sums.products[bin] +=
                left.middleCols<3>(ca).cwiseProduct(left.middleCols<3>(cb)).sum() / scale;
            sums.distance[bin] += d;
            ++sums.count[bin];
        }
}

/// Weighted line: log likeness = log near - distance / length, as far as it is above a twentieth.
Likeness likeness_of(const LikenessSums& sums) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t k = 0; k < LikenessSums::bins; ++k) {
        if (sums.count[k] < 1) continue;
        const double d = sums.distance[k] / sums.count[k],
                     value = std::min(sums.products[k] / sums.count[k], most_alike);
        if (value < 0.05) break;
        const double w = sums.count[k] * value * value;
        n += w;
        x += w * d;
        y += w * std::log(value);
        xx += w * d * d;
        xy += w * d * std::log(value);
    }
    const bool one_distance =
        !(n * xx - x * x > 1e-9 * n * xx); // then the line begins at perfect likeness
    const double slope = one_distance ? xy / xx : (n * xy - x * y) / (n * xx - x * x);
    if (!(slope < 0)) return {};
    return {std::min(std::exp((y - slope * x) / n), most_alike), -1 / slope};
}

constexpr double gate = 4; // deviations, in each direction

/// Gross errors stand alone: what is far from the forecast but like the sample before is a rock
/// that went its own way.
bool is_gross(const Vec3& off, const std::optional<Vec3>& off_before, double deviation) {
    if (off.squaredNorm() <= 3 * gate * gate * deviation * deviation) return false;
    return !off_before || (off - *off_before).squaredNorm() > 0.25 * off.squaredNorm();
}

/// By how far a rock of the forecast would have to turn, about a level axis, for upwards to be
/// where gravity says: yaw stays its own.
Vec3 tilted_off(const Vec3& tilt, const Quat& start, const Vec3& turned) {
    const Vec3 up = (start.conjugate() * Vec3::UnitZ() - tilt).normalized(); // in the body's axes
    return attitude_error(
        Quat::FromTwoVectors(exponential_map(turned) * (start * up), Vec3::UnitZ()),
        Quat::Identity());
}

/// What a sample is off the forecast by; nothing: not measured.
std::optional<Vec3> off_by(const SensorWay& way, std::ptrdiff_t place, const ModelRun& forecast,
                           Motions motion, std::size_t host) {
    if (place < 0) return {};
    const auto k = static_cast<std::size_t>(place);
    const auto stage = stage_of_sample(forecast, way.strain[k]);
    if (!stage) return {};
    const Vec3& foretold = (forecast.*motion)[*stage][host];
    const bool turns = motion == &ModelRun::rotation;
    const Vec3& told = turns ? way.rotation[k] : way.displacement[k];
    if (told.allFinite()) return Vec3(told - foretold);
    const bool tilts = turns && k < way.tilt.size() && way.tilt[k].allFinite();
    return tilts
               ? std::optional(tilted_off(way.tilt[k], forecast.start[host].orientation, foretold))
               : std::nullopt;
}

/// The last sample up to a strain; -1: none yet.
std::ptrdiff_t last_sample(const SensorWay& way, double strain) {
    return std::upper_bound(way.strain.begin(), way.strain.end(), strain + 1e-9) -
           way.strain.begin() - 1;
}

/// What the last sample of a sensor up to a strain was off by; nothing: none yet, or refused.
std::optional<Vec3> innovation_at(const SensorWay& way, const ModelRun& forecast, Motions motion,
                                  std::size_t host, double strain, double deviation) {
    for (auto k = last_sample(way, strain); k >= 0;
         --k) { // one that was refused leaves the one before
        const auto off = off_by(way, k, forecast, motion, host);
        if (off && !is_gross(*off, off_by(way, k - 1, forecast, motion, host), deviation))
            return off;
    }
    return {};
}

/// How far a rock is from its forecast, as its sensor says.
struct Innovation {
    std::size_t host;
    Vec3 off;
};

/// Carries those of one stage to all rocks.
void carry(ModelRun& run, Motions motion, std::size_t stage,
           const std::vector<Innovation>& innovations, const MotionScatter& scatter, double noise) {
    if (innovations.empty()) return;
    const std::vector<double>& deviation = scatter.deviation[stage];
    const auto covariance = [&](std::size_t a, std::size_t b) {
        return deviation[a] * deviation[b] *
               scatter.likeness((run.start[a].position - run.start[b].position).norm());
    };
    const auto m = static_cast<Eigen::Index>(innovations.size());
    const auto at = [&](Eigen::Index i) -> const Innovation& {
        return innovations[static_cast<std::size_t>(i)];
    };
    Matrix of_sensors(m, m), off(m, 3);
    for (Eigen::Index i = 0; i < m; ++i) {
        off.row(i) = at(i).off.transpose();
        for (Eigen::Index j = 0; j < m; ++j) of_sensors(i, j) = covariance(at(i).host, at(j).host);
        of_sensors(i, i) += noise * noise;
    }
    const Matrix weights = of_sensors.ldlt().solve(off);
    for (std::size_t rock = 0; rock < run.rocks.size(); ++rock)
        for (Eigen::Index i = 0; i < m; ++i)
            (run.*motion)[stage][rock] += covariance(rock, at(i).host) * weights.row(i).transpose();
}

// Recordings of another specimen are far from the forecast in most of their rocks and stay so; one
// rock that went its own way is no reason.
constexpr unsigned times_running = 3; // samples
constexpr std::size_t fewest_sensors =
    6; // that tell of all: three rocks that go their own way are soon chosen for just that

/// What one sample says of its rock, beside the forecast.
struct Judged {
    double off, distance, gain, deviation; // as in AnalysisRecord
    bool gross;
};

/// Nothing: not measured. The gain is that of the rock's own sample alone.
std::optional<Judged> judge(const SensorWay& way, std::ptrdiff_t sample, const ModelRun& forecast,
                            Motions motion, std::size_t host, double deviation, double noise) {
    const auto off = off_by(way, sample, forecast, motion, host);
    if (!off) return {};
    const double variance = deviation * deviation + noise * noise;
    const bool gross =
        is_gross(*off, off_by(way, sample - 1, forecast, motion, host), std::sqrt(variance));
    const double gain = gross ? 0 : deviation * deviation / variance;
    return Judged{off->norm(), off->squaredNorm() / variance, gain, deviation * std::sqrt(1 - gain),
                  gross};
}

/// Whether most sensors are farther off than those of the right specimen; nothing: too few to tell.
std::optional<bool> are_strange(std::vector<double> squared_distances) {
    if (squared_distances.size() < fewest_sensors) return {};
    return median(std::move(squared_distances)) > chi_squared_quantile(0.99, 3);
}

/// Counts and keeps what came since the stage before. Whether most of it is far from the forecast,
/// in displacements or in rotations; nothing: too little came to tell.
std::optional<bool> take_records(ModelRun& run, const ModelRun& forecast,
                                 const RockScatter& scatter, const SensorsHeard& sensors,
                                 std::size_t stage) {
    const double come = run.points[stage].axial_strain - sensors.lateness,
                 before = run.points[stage - 1].axial_strain - sensors.lateness;
    std::vector<double> shifts, turns; // squared distances
    for (std::size_t s = 0; s < sensors.hosts.size(); ++s) {
        const std::size_t host = sensors.hosts[s];
        const SensorWay& way = sensors.ways[s];
        const auto sample = last_sample(way, come);
        if (sample < 0 || sample == last_sample(way, before)) continue;
        AnalysisRecord& record = run.analyses.emplace_back(
            AnalysisRecord{.time = way.strain[static_cast<std::size_t>(sample)],
                           .sensor = static_cast<double>(s)});
        const auto shift =
            judge(way, sample, forecast, &ModelRun::displacement, host,
                  scatter.displacement.deviation[stage][host], sensors.position_noise);
        const auto turn = judge(way, sample, forecast, &ModelRun::rotation, host,
                                scatter.rotation.deviation[stage][host], sensors.attitude_noise);
        if (shift) {
            std::tie(record.shift_off, record.shift_distance, record.shift_gain,
                     record.shift_deviation) =
                std::tie(shift->off, shift->distance, shift->gain, shift->deviation);
            shifts.push_back(shift->distance);
        }
        if (turn) {
            std::tie(record.turn_off, record.turn_distance, record.turn_gain,
                     record.turn_deviation) =
                std::tie(turn->off, turn->distance, turn->gain, turn->deviation);
            turns.push_back(turn->distance);
        }
        for (const auto& judged : {shift, turn})
            if (judged) ++(judged->gross ? run.refused : run.accepted);
    }
    const auto shifted = are_strange(std::move(shifts)), turned = are_strange(std::move(turns));
    if (!shifted && !turned) return {};
    return shifted.value_or(false) || turned.value_or(false);
}

} // namespace

RockScatter scatter_of(const Worlds& worlds) {
    require(!worlds.runs.empty(), "analysis: expected worlds, found none");
    const Matrix leaves = WorldRegression(logarithms_of(worlds.beliefs)).leaves();
    const ModelRun& like = worlds.runs.front();
    const auto freedom = static_cast<double>(worlds.beliefs.size() - 3);
    const auto scatter_in = [&](Motions motion) {
        MotionScatter scatter;
        for (std::size_t stage = 0; stage < like.points.size(); ++stage)
            scatter.deviation.push_back(
                deviations_of(left_at(worlds, leaves, motion, stage), freedom));
        LikenessSums sums;
        for (std::size_t tenth = 1; tenth <= 10; ++tenth) {
            const std::size_t stage = tenth * (like.points.size() - 1) / 10;
            add_pairs(sums, like, left_at(worlds, leaves, motion, stage), scatter.deviation[stage]);
        }
        scatter.likeness = likeness_of(sums);
        return scatter;
    };
    return {scatter_in(&ModelRun::displacement), scatter_in(&ModelRun::rotation)};
}

void GrowingScatter::add(const Worlds& worlds) {
    require(!worlds.runs.empty(), "analysis: expected worlds, found none");
    const Matrix leaves = WorldRegression(logarithms_of(worlds.beliefs)).leaves();
    const ModelRun& like = worlds.runs.front();
    const auto freedom = static_cast<double>(worlds.beliefs.size() - 3);
    const auto add_to = [&](MotionScatter& scatter, LikenessSums& sums, Motions motion) {
        for (std::size_t stage = scatter.deviation.size(); stage < like.points.size(); ++stage) {
            Matrix left = left_at(worlds, leaves, motion, stage);
            scatter.deviation.push_back(deviations_of(left, freedom));
            if (stage == 0 || stage % every_ != 0) continue;
            add_pairs(sums, like, std::move(left), scatter.deviation[stage]);
            scatter.likeness = likeness_of(sums);
        }
    };
    add_to(scatter_.displacement, displacement_, &ModelRun::displacement);
    add_to(scatter_.rotation, rotation_, &ModelRun::rotation);
}

void analyse_stage(ModelRun& run, const ModelRun& forecast, const RockScatter& scatter,
                   const SensorsHeard& sensors, std::size_t stage) {
    require(sensors.hosts.size() == sensors.ways.size(), "analysis: expected a way for each host");
    const double come = run.points[stage].axial_strain - sensors.lateness;
    const auto correct = [&](Motions motion, const MotionScatter& of, double noise) {
        std::vector<Innovation> innovations; // held from one sample to the next
        for (std::size_t s = 0; s < sensors.hosts.size(); ++s) {
            const std::size_t host = sensors.hosts[s];
            const auto off = innovation_at(sensors.ways[s], forecast, motion, host, come,
                                           std::hypot(of.deviation[stage][host], noise));
            if (off) innovations.push_back({host, *off});
        }
        carry(run, motion, stage, innovations, of, noise);
    };
    correct(&ModelRun::displacement, scatter.displacement, sensors.position_noise);
    correct(&ModelRun::rotation, scatter.rotation, sensors.attitude_noise);
}

ModelRun analyse(const ModelRun& forecast, const RockScatter& scatter,
                 const SensorsHeard& sensors) {
    ModelRun run = forecast;
    unsigned strange = 0; // times running
    for (std::size_t stage = 1;
         stage < std::min(forecast.points.size(), scatter.displacement.deviation.size()); ++stage) {
        const auto far = take_records(run, forecast, scatter, sensors, stage);
        if (far) strange = *far ? strange + 1 : 0;
        if (strange == times_running) {
            run.strange_from = run.points[stage].axial_strain;
            break;
        }
        analyse_stage(run, forecast, scatter, sensors, stage);
    }
    return run;
}

} // namespace bris

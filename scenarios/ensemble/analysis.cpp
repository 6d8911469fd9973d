#include "scenarios/ensemble/analysis.hpp"

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

/// Residuals of the members beyond their regression at one stage: members x (3 rocks).
Matrix residuals_at(const Ensemble& members, const Matrix& residual_projection, Motions motion,
                    std::size_t stage) {
    const auto n = static_cast<Eigen::Index>(members.runs.size());
    const auto rocks = static_cast<Eigen::Index>(members.runs.front().rocks.size());
    Matrix all(n, 3 * rocks);
    for (Eigen::Index j = 0; j < n; ++j)
        for (Eigen::Index r = 0; r < rocks; ++r)
            for (Eigen::Index c = 0; c < 3; ++c)
                all(j, 3 * r + c) = (members.runs[static_cast<std::size_t>(j)].*
                                     motion)[stage][static_cast<std::size_t>(r)][c];
    return residual_projection * all;
}

constexpr double most_alike = 0.95; // largest correlation of two rocks

/// Standard deviation of each rock along one axis. Members are few, so the variances of all rocks
/// are moderated towards each other.
std::vector<double> deviations_of(const Matrix& left, double freedom) {
    std::vector<double> deviations(static_cast<std::size_t>(left.cols() / 3));
    for (std::size_t r = 0; r < deviations.size(); ++r)
        deviations[r] =
            left.middleCols<3>(static_cast<Eigen::Index>(3 * r)).squaredNorm() / (3 * freedom);
    deviations = moderated_variances(std::move(deviations), 3 * freedom);
    for (double& d : deviations) d = std::sqrt(d);
    return deviations;
}

/// Adds the products of all pairs of rocks at one stage.
void add_pairs(CorrelationSums& sums, const ModelRun& like, Matrix left,
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
            // the bins cover half of the largest distance
            const auto bin = static_cast<std::size_t>(2 * CorrelationSums::bins * d / reach);
            if (bin >= CorrelationSums::bins) continue;
            const auto ca = static_cast<Eigen::Index>(3 * a), cb = static_cast<Eigen::Index>(3 * b);
            sums.products[bin] +=
                left.middleCols<3>(ca).cwiseProduct(left.middleCols<3>(cb)).sum() / scale;
            sums.distance[bin] += d;
            ++sums.count[bin];
        }
}

/// Fits log correlation = log near - distance / length by weighted least squares, up to the
/// distance at which the correlation falls below 0.05.
CorrelationFunction correlation_of(const CorrelationSums& sums) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t k = 0; k < CorrelationSums::bins; ++k) {
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
    // with a single distance the line starts at correlation 1
    const bool one_distance = !(n * xx - x * x > 1e-9 * n * xx);
    const double slope = one_distance ? xy / xx : (n * xy - x * y) / (n * xx - x * x);
    if (!(slope < 0)) return {};
    return {std::min(std::exp((y - slope * x) / n), most_alike), -1 / slope};
}

constexpr double gate = 4; // standard deviations, along each axis

/// Outliers are isolated: a sample that is far from the forecast but like the one before it shows
/// that the rock itself departs from the forecast.
bool is_isolated_outlier(const Vec3& innovation, const std::optional<Vec3>& innovation_before,
                         double deviation) {
    if (innovation.squaredNorm() <= 3 * gate * gate * deviation * deviation) return false;
    return !innovation_before ||
           (innovation - *innovation_before).squaredNorm() > 0.25 * innovation.squaredNorm();
}

/// Rotation about a horizontal axis that brings the vertical of a forecast rock to that given by
/// gravity; the yaw of the forecast is kept.
Vec3 tilt_innovation(const Vec3& tilt, const Quat& start, const Vec3& turned) {
    const Vec3 up = (start.conjugate() * Vec3::UnitZ() - tilt).normalized(); // in the body's axes
    return attitude_error(shortest_rotation(exponential_map(turned) * (start * up), Vec3::UnitZ()),
                          Quat::Identity());
}

/// Innovation of a sample, observation minus forecast; nothing if not measured.
std::optional<Vec3> innovation_of(const SensorTrajectory& trajectory, std::ptrdiff_t sample,
                                  const ModelRun& forecast, Motions motion, std::size_t host) {
    if (sample < 0) return {};
    const auto k = static_cast<std::size_t>(sample);
    const auto stage = stage_of_sample(forecast, trajectory.strain[k]);
    if (!stage) return {};
    const Vec3& predicted = (forecast.*motion)[*stage][host];
    const bool turns = motion == &ModelRun::rotation;
    const Vec3& observed = turns ? trajectory.rotation[k] : trajectory.displacement[k];
    if (observed.allFinite()) return Vec3(observed - predicted);
    const bool tilts = turns && k < trajectory.tilt.size() && trajectory.tilt[k].allFinite();
    return tilts ? std::optional(tilt_innovation(trajectory.tilt[k],
                                                 forecast.start[host].orientation, predicted))
                 : std::nullopt;
}

/// The last sample up to a strain; -1: none yet.
std::ptrdiff_t last_sample(const SensorTrajectory& trajectory, double strain) {
    return std::upper_bound(trajectory.strain.begin(), trajectory.strain.end(), strain + 1e-9) -
           trajectory.strain.begin() - 1;
}

/// Innovation of the last sample of a sensor up to a strain that is not an outlier; nothing if
/// there is none.
std::optional<Vec3> innovation_at(const SensorTrajectory& trajectory, const ModelRun& forecast,
                                  Motions motion, std::size_t host, double strain,
                                  double deviation) {
    for (auto k = last_sample(trajectory, strain); k >= 0; --k) {
        const auto innovation = innovation_of(trajectory, k, forecast, motion, host);
        if (innovation &&
            !is_isolated_outlier(
                *innovation, innovation_of(trajectory, k - 1, forecast, motion, host), deviation))
            return innovation;
    }
    return {};
}

/// Innovation of the sensor on rock `host`.
struct Innovation {
    std::size_t host;
    Vec3 innovation;
};

/// Corrects all rocks at one stage by the innovations of the sensors.
void interpolate_innovations(ModelRun& run, Motions motion, std::size_t stage,
                             const std::vector<Innovation>& innovations,
                             const MotionScatter& scatter, double noise) {
    if (innovations.empty()) return;
    const std::vector<double>& deviation = scatter.deviation[stage];
    const auto covariance = [&](std::size_t a, std::size_t b) {
        return deviation[a] * deviation[b] *
               scatter.correlation((run.start[a].position - run.start[b].position).norm());
    };
    const auto m = static_cast<Eigen::Index>(innovations.size());
    const auto at = [&](Eigen::Index i) -> const Innovation& {
        return innovations[static_cast<std::size_t>(i)];
    };
    Matrix of_sensors(m, m), innovation(m, 3);
    for (Eigen::Index i = 0; i < m; ++i) {
        innovation.row(i) = at(i).innovation.transpose();
        for (Eigen::Index j = 0; j < m; ++j) of_sensors(i, j) = covariance(at(i).host, at(j).host);
        of_sensors(i, i) += noise * noise;
    }
    const Matrix weights = of_sensors.ldlt().solve(innovation);
    for (std::size_t rock = 0; rock < run.rocks.size(); ++rock)
        for (Eigen::Index i = 0; i < m; ++i)
            (run.*motion)[stage][rock] += covariance(rock, at(i).host) * weights.row(i).transpose();
}

// Recordings of another specimen are far from the forecast for most rocks, and stay so; a single
// rock that departs from the forecast is no reason to reject them.
constexpr unsigned times_running = 3; // successive samples
// Sensors needed for a verdict: three rocks may all depart from the forecast by chance, or may have
// been chosen for it.
constexpr std::size_t fewest_sensors = 6;

/// The observation of one sample compared with the forecast.
struct Assessment {
    double innovation, distance, gain, deviation; // as in AnalysisRecord
    bool outlier;
};

/// Nothing if not measured. The gain is that of the rock's own sample alone.
std::optional<Assessment> assess(const SensorTrajectory& trajectory, std::ptrdiff_t sample,
                                 const ModelRun& forecast, Motions motion, std::size_t host,
                                 double deviation, double noise) {
    const auto innovation = innovation_of(trajectory, sample, forecast, motion, host);
    if (!innovation) return {};
    const double variance = deviation * deviation + noise * noise;
    const bool outlier = is_isolated_outlier(
        *innovation, innovation_of(trajectory, sample - 1, forecast, motion, host),
        std::sqrt(variance));
    const double gain = outlier ? 0 : deviation * deviation / variance;
    return Assessment{innovation->norm(), innovation->squaredNorm() / variance, gain,
                      deviation * std::sqrt(1 - gain), outlier};
}

/// Whether most innovations are larger than those of the same specimen would be; nothing if there
/// are too few to tell.
std::optional<bool> are_inconsistent(std::vector<double> squared_distances) {
    if (squared_distances.size() < fewest_sensors) return {};
    return median(std::move(squared_distances)) > chi_squared_quantile(0.99, 3);
}

/// Counts and records the samples that arrived since the previous stage. Returns whether most of
/// them are far from the forecast, in displacement or in rotation; nothing if too few arrived to
/// tell.
std::optional<bool> record_innovations(ModelRun& run, const ModelRun& forecast,
                                       const RockScatter& scatter,
                                       const AssimilatedSensors& sensors, std::size_t stage) {
    const double arrived = run.curves[quantity::axial_strain][stage],
                 before = run.curves[quantity::axial_strain][stage - 1];
    std::vector<double> shifts, turns; // normalised innovations squared
    for (std::size_t s = 0; s < sensors.hosts.size(); ++s) {
        const std::size_t host = sensors.hosts[s];
        const SensorTrajectory& trajectory = sensors.trajectories[s];
        const auto sample = last_sample(trajectory, arrived);
        if (sample < 0 || sample == last_sample(trajectory, before)) continue;
        AnalysisRecord& record = run.analyses.emplace_back(
            AnalysisRecord{.time = trajectory.strain[static_cast<std::size_t>(sample)],
                           .sensor = static_cast<double>(s)});
        const auto shift =
            assess(trajectory, sample, forecast, &ModelRun::displacement, host,
                   scatter.displacement.deviation[stage][host], sensors.position_noise);
        const auto turn = assess(trajectory, sample, forecast, &ModelRun::rotation, host,
                                 scatter.rotation.deviation[stage][host], sensors.attitude_noise);
        if (shift) {
            std::tie(record.position_innovation, record.position_normalised_innovation_squared,
                     record.position_gain, record.position_deviation) =
                std::tie(shift->innovation, shift->distance, shift->gain, shift->deviation);
            shifts.push_back(shift->distance);
        }
        if (turn) {
            std::tie(record.attitude_innovation, record.attitude_normalised_innovation_squared,
                     record.attitude_gain, record.attitude_deviation) =
                std::tie(turn->innovation, turn->distance, turn->gain, turn->deviation);
            turns.push_back(turn->distance);
        }
        for (const auto& assessment : {shift, turn})
            if (assessment) ++(assessment->outlier ? run.refused : run.accepted);
    }
    const auto shifted = are_inconsistent(std::move(shifts)),
               turned = are_inconsistent(std::move(turns));
    if (!shifted && !turned) return {};
    return shifted.value_or(false) || turned.value_or(false);
}

} // namespace

RockScatter scatter_of(const Ensemble& members) {
    require(!members.runs.empty(), "analysis: expected ensemble members, found none");
    const Matrix residual_projection =
        EnsembleRegression(logarithms_of(members.parameters)).residual_projection();
    const ModelRun& like = members.runs.front();
    const auto freedom = static_cast<double>(members.parameters.size() - 3);
    const auto scatter_in = [&](Motions motion) {
        MotionScatter scatter;
        for (std::size_t stage = 0; stage < like.curves.size(); ++stage)
            scatter.deviation.push_back(
                deviations_of(residuals_at(members, residual_projection, motion, stage), freedom));
        CorrelationSums sums;
        for (std::size_t tenth = 1; tenth <= 10; ++tenth) {
            const std::size_t stage = tenth * (like.curves.size() - 1) / 10;
            add_pairs(sums, like, residuals_at(members, residual_projection, motion, stage),
                      scatter.deviation[stage]);
        }
        scatter.correlation = correlation_of(sums);
        return scatter;
    };
    return {scatter_in(&ModelRun::displacement), scatter_in(&ModelRun::rotation)};
}

void GrowingScatter::add(const Ensemble& members) {
    require(!members.runs.empty(), "analysis: expected ensemble members, found none");
    const Matrix residual_projection =
        EnsembleRegression(logarithms_of(members.parameters)).residual_projection();
    const ModelRun& like = members.runs.front();
    const auto freedom = static_cast<double>(members.parameters.size() - 3);
    const auto add_to = [&](MotionScatter& scatter, CorrelationSums& sums, Motions motion) {
        for (std::size_t stage = scatter.deviation.size(); stage < like.curves.size(); ++stage) {
            Matrix left = residuals_at(members, residual_projection, motion, stage);
            scatter.deviation.push_back(deviations_of(left, freedom));
            if (stage == 0 || stage % every_ != 0) continue;
            add_pairs(sums, like, std::move(left), scatter.deviation[stage]);
            scatter.correlation = correlation_of(sums);
        }
    };
    add_to(scatter_.displacement, displacement_, &ModelRun::displacement);
    add_to(scatter_.rotation, rotation_, &ModelRun::rotation);
}

void compute_analysis_stage(ModelRun& run, const ModelRun& forecast, const RockScatter& scatter,
                            const AssimilatedSensors& sensors, std::size_t stage) {
    require(sensors.hosts.size() == sensors.trajectories.size(),
            "analysis: expected a trajectory for each host");
    const double arrived = run.curves[quantity::axial_strain][stage];
    const auto correct = [&](Motions motion, const MotionScatter& of, double noise) {
        std::vector<Innovation> innovations; // each held until the next sample of its sensor
        for (std::size_t s = 0; s < sensors.hosts.size(); ++s) {
            const std::size_t host = sensors.hosts[s];
            const auto innovation =
                innovation_at(sensors.trajectories[s], forecast, motion, host, arrived,
                              std::hypot(of.deviation[stage][host], noise));
            if (innovation) innovations.push_back({host, *innovation});
        }
        interpolate_innovations(run, motion, stage, innovations, of, noise);
    };
    correct(&ModelRun::displacement, scatter.displacement, sensors.position_noise);
    correct(&ModelRun::rotation, scatter.rotation, sensors.attitude_noise);
}

ModelRun compute_analysis(const ModelRun& forecast, const RockScatter& scatter,
                          const AssimilatedSensors& sensors) {
    ModelRun run = forecast;
    unsigned inconsistent = 0; // successive samples
    for (std::size_t stage = 1;
         stage < std::min(forecast.curves.size(), scatter.displacement.deviation.size()); ++stage) {
        const auto far = record_innovations(run, forecast, scatter, sensors, stage);
        if (far) inconsistent = *far ? inconsistent + 1 : 0;
        if (inconsistent == times_running) {
            run.inconsistent_from = run.curves[quantity::axial_strain][stage];
            break;
        }
        compute_analysis_stage(run, forecast, scatter, sensors, stage);
    }
    return run;
}

} // namespace bris

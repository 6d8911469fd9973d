#include "scenarios/ensemble/learning.hpp"

#include "engine/errors.hpp"
#include "scenarios/ensemble/specimen_correlation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

namespace bris {

namespace {

constexpr double compaction = 1e-3;   // volumetric strain of a specimen before it dilates
constexpr double volume_noise = 0.02; // relative, of volumetric strain as measured
// deviation of ln q by slips: members slip like the specimen, but at other strains
constexpr double slip = 0.35;
// in standard deviations of ln q; no member of the twin campaign is 3 away from the others
constexpr double outlier_limit = 6;
/// Channels of the estimate: quantities that are measured in a test and forecast by the members.
enum Channel : std::size_t { strength, widening, dilation, channels };

/// A sample of a sensor, and the stage of the members at its strain.
struct Observation {
    std::size_t sensor, sample, stage;
};

/// Whether a sensor rock moves outwards as the specimen widens: one near the axis does not.
bool stands_off_axis(const ModelRun& run, std::size_t sensor) {
    constexpr double middle = 0.02; // m
    return run.start[sensor].position.head<2>().norm() >= middle;
}

/// Mean displacement away from the axis of the observed sensor rocks.
double outwards(const ModelRun& run, const std::vector<Observation>& observations,
                const std::function<Vec3(const Observation&)>& displacement) {
    double sum = 0;
    for (const Observation& h : observations) {
        Vec3 out = run.start[h.sensor].position;
        out.z() = 0;
        sum += displacement(h).dot(out.normalized());
    }
    return observations.empty() ? 0 : sum / static_cast<double>(observations.size());
}

/// All members of an ensemble, or some of them.
struct MemberSubset {
    std::vector<RockParameters> parameters;
    std::vector<const ModelRun*> runs;
};

/// Means over a window of strain: of the measurements, and of the forecast of each member at the
/// same strains.
struct Means {
    double measured = 0;
    Vector forecast;
};

/// One quantity at a stage, as forecast by each member.
Vector forecast_at(const MemberSubset& members, std::size_t stage, const Quantity& what) {
    return Vector::NullaryExpr(static_cast<Eigen::Index>(members.runs.size()), [&](Eigen::Index j) {
        return members.runs[static_cast<std::size_t>(j)]->curves[what][stage];
    });
}

/// Nothing if the quantity was not measured in the window.
std::optional<Means> means_of(const MeasuredCurves& measured, const MemberSubset& members,
                              const Quantity& what, double from, double to) {
    Means m{0, Vector::Zero(static_cast<Eigen::Index>(members.runs.size()))};
    double count = 0;
    const auto &strain = measured[quantity::axial_strain], &found = measured[what];
    for (std::size_t k = 0; k < measured.size(); ++k) {
        if (strain[k] <= from + 1e-9 || strain[k] > to + 1e-9 || !std::isfinite(found[k])) continue;
        const auto stage = stage_of_sample(*members.runs.front(), strain[k]);
        if (!stage) continue;
        m.measured += found[k];
        m.forecast += forecast_at(members, *stage, what);
        ++count;
    }
    if (count == 0) return {};
    m.measured /= count;
    m.forecast /= count;
    return m;
}

/// Whether ln q is an outlier to the whole ensemble, even if specimens differ.
bool is_stress_outlier(double found, const Vector& forecast, double specimen_scatter) {
    const double mean = forecast.mean(), scatter = std::max(specimen_scatter, slip);
    const double variance =
        (forecast.array() - mean).square().sum() / static_cast<double>(forecast.size() - 1) +
        scatter * scatter;
    return std::pow(found - mean, 2) > outlier_limit * outlier_limit * variance;
}

/// A test without the outliers of q.
struct CleanTest : Measurements {
    std::vector<double> rejected = {}; ///< axial strains of the outliers
};
CleanTest cleaned(const MemberSubset& members, const Measurements& measured,
                  const Learning& settings) {
    CleanTest m{measured};
    const auto& strain = m.curves[quantity::axial_strain];
    auto& q = m.curves[quantity::deviatoric_stress];
    for (std::size_t k = 0; k < m.curves.size(); ++k) {
        const auto stage = stage_of_sample(*members.runs.front(), strain[k]);
        if (!stage || !(strain[k] > 1e-9) || !(q[k] > no_stress)) continue;
        const Vector forecast = forecast_at(members, *stage, quantity::deviatoric_stress);
        if (!(forecast.minCoeff() > no_stress) ||
            !is_stress_outlier(std::log(q[k]), forecast.array().log(), settings.specimen_scatter))
            continue;
        q[k] = std::nan("");
        m.rejected.push_back(strain[k]);
    }
    return m;
}

/// Whether a displacement is an outlier to the whole ensemble: farther from its mean than ten
/// standard deviations of members and noise.
bool is_displacement_outlier(const MemberSubset& members, const Observation& h, const Vec3& found,
                             double noise) {
    Vec3 mean = Vec3::Zero();
    double squares = 0;
    for (const ModelRun* run : members.runs)
        mean += run->displacement[h.stage][h.sensor] / static_cast<double>(members.runs.size());
    for (const ModelRun* run : members.runs)
        squares += (run->displacement[h.stage][h.sensor] - mean).squaredNorm();
    const double variance =
        squares / static_cast<double>(members.runs.size() - 1) + 3 * noise * noise;
    return (found - mean).squaredNorm() > 100 * variance;
}

/// The last sample of each sensor that was taken in a window, allowing for their delay. None if
/// fewer than half of the sensors have one.
std::vector<Observation> observations_in(const MemberSubset& members, const Measurements& measured,
                                         double from, double to) {
    const ModelRun& like = *members.runs.front();
    std::vector<Observation> observations;
    std::size_t expected = 0;
    for (std::size_t s = 0; s < std::min(measured.trajectories.size(), like.sensors); ++s) {
        const SensorTrajectory& trajectory = measured.trajectories[s];
        if (trajectory.strain.empty() || !stands_off_axis(like, s)) continue;
        ++expected;
        const auto after =
            std::upper_bound(trajectory.strain.begin(), trajectory.strain.end(), to + 1e-9);
        for (auto k = after - trajectory.strain.begin() - 1; k >= 0; --k) {
            const auto sample = static_cast<std::size_t>(k);
            if (trajectory.strain[sample] <= from + 1e-9) break;
            const auto stage = stage_of_sample(like, trajectory.strain[sample]);
            if (!stage || !trajectory.displacement[sample].allFinite()) continue;
            const Observation h{s, sample, *stage};
            if (is_displacement_outlier(members, h, trajectory.displacement[sample],
                                        measured.displacement_noise))
                continue;
            observations.push_back(h);
            break;
        }
    }
    if (2 * observations.size() < expected) observations.clear();
    return observations;
}

/// Assimilates ln q.
bool observe_strength(ParameterEstimate& estimate, const MemberSubset& members,
                      const Measurements& measured, const Learning& settings, double from,
                      double to) {
    const auto q = means_of(measured.curves, members, quantity::deviatoric_stress, from, to);
    if (!q || !(q->measured > no_stress) || !(q->forecast.minCoeff() > no_stress)) return false;
    estimate.observe(
        strength, q->forecast.array().log(),
        {std::log(q->measured), settings.force_noise, settings.specimen_scatter, std::log(to)});
    return true;
}

/// Assimilates the mean outward displacement of the sensor rocks. Specimens differ by a fraction of
/// it.
bool observe_sensor_displacements(ParameterEstimate& estimate, const MemberSubset& members,
                                  const Measurements& measured, const Learning& settings,
                                  double from, double to) {
    const std::vector<Observation> observations = observations_in(members, measured, from, to);
    if (observations.empty()) return false;
    Vector forecast(static_cast<Eigen::Index>(members.runs.size()));
    for (std::size_t j = 0; j < members.runs.size(); ++j)
        forecast[static_cast<Eigen::Index>(j)] =
            outwards(*members.runs[j], observations, [&](const Observation& h) {
                return members.runs[j]->displacement[h.stage][h.sensor];
            });
    const double found = outwards(*members.runs.front(), observations, [&](const Observation& h) {
        return measured.trajectories[h.sensor].displacement[h.sample];
    });
    const double noise =
        measured.displacement_noise / std::sqrt(static_cast<double>(observations.size()));
    estimate.observe(
        widening, forecast,
        {found, noise, settings.specimen_scatter * forecast.cwiseAbs().mean(), std::log(to)});
    return true;
}

/// Assimilates dilation, in units that grow with strain as the differences between specimens do.
bool observe_volume(ParameterEstimate& estimate, const MemberSubset& members,
                    const Measurements& measured, const Learning& settings, double from,
                    double to) {
    const auto volume = means_of(measured.curves, members, quantity::volumetric_strain, from, to);
    if (!volume) return false;
    const double size = std::abs(volume->forecast.mean()),
                 unit = -(size + compaction); // compression is positive
    // before dilation all specimens are alike, which would suggest that this one continues like the
    // members
    if (!(size > compaction)) return false;
    estimate.observe(
        dilation, volume->forecast / unit,
        {volume->measured / unit, volume_noise, settings.specimen_scatter, std::log(to)});
    return true;
}

enum class ReportAt { every_window, final_strain_only };

/// `excluded_members`: number of members that are left out of the ensemble.
std::vector<EstimateAt> learn_tempered(const Gaussian& prior, const MemberSubset& members,
                                       const CleanTest& measured, const Learning& settings,
                                       double final_strain, double tempering, ReportAt report_at,
                                       Eigen::Index excluded_members = 0) {
    ParameterEstimate estimate(prior, logarithms_of(members.parameters), channels, tempering,
                               excluded_members, specimen_correlation);
    std::vector<EstimateAt> estimates;
    double from = 0;
    for (const double to : window_ends(settings, final_strain)) {
        bool observed_any =
            settings.by_force && observe_strength(estimate, members, measured, settings, from, to);
        const double distance =
            observed_any ? estimate.normalised_innovation_squared(strength) : -1;
        if (settings.by_sensors &&
            observe_sensor_displacements(estimate, members, measured, settings, from, to))
            observed_any = true;
        if (settings.by_volume && observe_volume(estimate, members, measured, settings, from, to))
            observed_any = true;
        const auto rejected_here =
            static_cast<unsigned>(std::ranges::count_if(measured.rejected, [&](double strain) {
                return strain > from + 1e-9 && strain <= to + 1e-9;
            }));
        if ((observed_any || rejected_here > 0) && report_at == ReportAt::every_window)
            estimates.push_back({to, estimate.parameters(), distance, rejected_here});
        from = to;
    }
    if (report_at == ReportAt::final_strain_only)
        estimates.push_back({final_strain, estimate.parameters(), -1});
    return estimates;
}

/// Synthetic measurements of a member, at the strains of a real test.
CleanTest as_measured(const ModelRun& run, const CleanTest& like) {
    CleanTest m = like;
    for (std::size_t k = 0; k < m.curves.size(); ++k) {
        const auto stage = stage_of_sample(run, m.curves[quantity::axial_strain][k]);
        for (const Quantity* q : {&quantity::deviatoric_stress, &quantity::volumetric_strain})
            if (std::isfinite(m.curves[*q][k]))
                m.curves[*q][k] = stage ? run.curves[*q][*stage] : std::nan("");
    }
    for (std::size_t s = 0; s < m.trajectories.size() && s < run.sensors; ++s)
        for (std::size_t k = 0; k < m.trajectories[s].strain.size(); ++k) {
            const auto stage = stage_of_sample(run, m.trajectories[s].strain[k]);
            if (stage && m.trajectories[s].displacement[k].allFinite())
                m.trajectories[s].displacement[k] = run.displacement[*stage][s];
        }
    return m;
}

/// Likelihood tempering by leave-one-out cross-validation: each member in turn is taken as the
/// truth, and its parameters are estimated from the others. Where the errors are larger than the
/// estimates claim, the divergence of single runs persists longer than its correlation at
/// successive times accounts for, and the measurements are given less weight. Returns 1 if the
/// ensemble has no more than the fewest members.
double tempering_for(const Gaussian& prior, const MemberSubset& members, const CleanTest& measured,
                     const Learning& settings, double final_strain) {
    if (members.runs.size() <= ParameterEstimate::fewest_members) return 1;
    Learning same_specimen = settings;
    same_specimen.specimen_scatter = 0;
    double sum = 0;
    for (std::size_t j = 0; j < members.runs.size(); ++j) {
        MemberSubset others = members;
        others.parameters.erase(others.parameters.begin() + static_cast<std::ptrdiff_t>(j));
        others.runs.erase(others.runs.begin() + static_cast<std::ptrdiff_t>(j));
        const auto estimates =
            learn_tempered(prior, others, as_measured(*members.runs[j], measured), same_specimen,
                           final_strain, 1, ReportAt::final_strain_only, 1);
        sum += squared_distance(estimates.back().estimate, logarithms_of(members.parameters[j]));
    }
    return std::min(1.0, 2 * static_cast<double>(members.runs.size()) / sum);
}

MemberSubset all_members(const Ensemble& members) {
    require(members.runs.size() == members.parameters.size(),
            fmt::format("ensemble members: expected {} runs, found {}", members.parameters.size(),
                        members.runs.size()));
    MemberSubset subset{members.parameters, {}};
    for (const ModelRun& run : members.runs) subset.runs.push_back(&run);
    return subset;
}

} // namespace

Gaussian prior_of(const RockParameters& middle, const Learning& settings) {
    Gaussian prior(2);
    prior.mean = logarithms_of(middle);
    prior.root.diagonal() << settings.friction_deviation, settings.stiffness_deviation;
    return prior;
}

std::vector<double> window_ends(const Learning& settings, double final_strain) {
    std::vector<double> ends;
    // narrow windows at first, where q depends on stiffness, then wide ones
    for (double from = 0; from < final_strain - 1e-9; from = ends.back())
        ends.push_back(std::min(
            from + std::clamp(0.5 * from, settings.first_window, settings.window), final_strain));
    return ends;
}

std::vector<EstimateAt> learn(const Gaussian& prior, const Ensemble& members,
                              const Measurements& measured, const Learning& settings,
                              double final_strain) {
    const MemberSubset subset = all_members(members);
    const CleanTest test = cleaned(subset, measured, settings);
    return learn_tempered(prior, subset, test, settings, final_strain,
                          tempering_for(prior, subset, test, settings, final_strain),
                          ReportAt::every_window);
}

std::size_t outlying_displacements(const Ensemble& members, const Measurements& measured) {
    const MemberSubset subset = all_members(members);
    std::size_t outliers = 0;
    for (std::size_t s = 0;
         s < std::min(measured.trajectories.size(), members.runs.front().sensors); ++s)
        for (std::size_t k = 0; k < measured.trajectories[s].strain.size(); ++k) {
            const Vec3& found = measured.trajectories[s].displacement[k];
            const auto stage =
                stage_of_sample(members.runs.front(), measured.trajectories[s].strain[k]);
            if (stage && found.allFinite() &&
                is_displacement_outlier(subset, {s, k, *stage}, found, measured.displacement_noise))
                ++outliers;
        }
    return outliers;
}

} // namespace bris

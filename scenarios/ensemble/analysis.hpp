#pragma once

#include "scenarios/ensemble/model_ensemble.hpp"

#include <array>

namespace bris {

/// Spatial correlation of the forecast errors of two rocks: near * exp(-distance / length); 1 at
/// distance 0, for a rock and itself.
struct CorrelationFunction {
    double near = 0, length = 0; ///< -, m
    double operator()(double distance) const {
        return distance > 0 ? near * std::exp(-distance / length) : 1;
    }
};

/// Sums over pairs of rocks, in bins of their distance, from which the correlation function is
/// fitted.
struct CorrelationSums {
    static constexpr std::size_t bins = 24;
    std::array<double, bins> products{}, count{}, distance{};
};

/// Ensemble spread of one kind of rock motion: the residuals of the members beyond the regression
/// on their parameters.
struct MotionScatter {
    CorrelationFunction correlation;
    /// m or rad, standard deviation along one axis, by stage and rock.
    std::vector<std::vector<double>> deviation;
};

struct RockScatter {
    MotionScatter displacement, rotation;
};
/// The ensemble spread at all stages; the correlation function is fitted to ten of them. Throws
/// InputError for an empty ensemble.
RockScatter scatter_of(const Ensemble& members);

/// The ensemble spread of members that are still running: deviations stage by stage, the
/// correlation function from the stages so far.
class GrowingScatter {
public:
    /// `every`: number of stages between those that the correlation function is fitted to.
    explicit GrowingScatter(std::size_t every) : every_(every) {}
    /// Adds the stages that the members have reached since the last call. Throws InputError for an
    /// empty ensemble.
    void add(const Ensemble& members);
    const RockScatter& scatter() const { return scatter_; }

private:
    std::size_t every_;
    RockScatter scatter_;
    CorrelationSums displacement_, rotation_;
};

/// Observations of sensors, and the rocks of a run that carry them.
struct AssimilatedSensors {
    std::vector<std::size_t> hosts;
    const std::vector<SensorTrajectory>& trajectories; ///< one for each host
    double position_noise, attitude_noise; ///< m and rad, standard deviations of the trajectories
};

/// The analysis of rock motions: corrects the forecast by the observations of the rocks that carry
/// sensors, by optimal interpolation (Gandin 1963). The residuals of the ensemble members beyond
/// the regression on their parameters give the forecast error covariance: a deviation for each rock
/// and stage, and a correlation that decreases with distance. It carries the innovations of the
/// sensors to all other rocks. The members themselves are not changed, so none is moved out of
/// equilibrium. No sample is used before its strain or before it has arrived. An outlier, far from
/// the forecast and unlike the sample before it, is rejected. Where a trajectory has no rotations,
/// the tilt that gravity gives is used. The analysis assumes that the members are packed like the
/// specimen: where most of at least six sensors are far from the forecast for several successive
/// samples, the sensors are taken to be of another specimen and are left out from then on
/// (inconsistent_from). Samples are counted and recorded (analyses). Throws InputError unless there
/// is one trajectory for each host.
ModelRun compute_analysis(const ModelRun& forecast, const RockScatter& scatter,
                          const AssimilatedSensors& sensors);
/// The analysis of one stage of `run`, which holds the forecast there; without the check whether
/// the sensors are of the same specimen.
void compute_analysis_stage(ModelRun& run, const ModelRun& forecast, const RockScatter& scatter,
                            const AssimilatedSensors& sensors, std::size_t stage);

} // namespace bris

#pragma once

#include "scenarios/assimilation/model_ensemble.hpp"

#include <array>

namespace bris {

/// How alike rocks at a distance err: near * exp(-distance / length) for two, 1 for one and the
/// same.
struct CorrelationFunction {
    double near = 0, length = 0; ///< -, m
    double operator()(double distance) const {
        return distance > 0 ? near * std::exp(-distance / length) : 1;
    }
};

/// What a likeness over distance is taken from: sums over pairs of rocks, in bins of their
/// distance.
struct CorrelationSums {
    static constexpr std::size_t bins = 24;
    std::array<double, bins> products{}, count{}, distance{};
};

/// How one kind of rocks' motions scatters over worlds, beyond the regression on their beliefs.
struct MotionScatter {
    CorrelationFunction correlation;
    std::vector<std::vector<double>> deviation; ///< m or rad, of one direction, by stage and rock
};

struct RockScatter {
    MotionScatter displacement, rotation;
};
RockScatter scatter_of(const Ensemble& members);

/// The same while worlds go on: deviations stage by stage, likeness over distance from stages so
/// far.
class GrowingScatter {
public:
    /// Likeness is taken at every so many stages.
    explicit GrowingScatter(std::size_t every) : every_(every) {}
    /// The stages that worlds have and this has not, and of each what it says of all.
    void add(const Ensemble& members);
    const RockScatter& scatter() const { return scatter_; }

private:
    std::size_t every_;
    RockScatter scatter_;
    CorrelationSums displacement_, rotation_;
};

/// What sensors told, and of which rocks of a run.
struct AssimilatedSensors {
    std::vector<std::size_t> hosts;
    const std::vector<SensorTrajectory>& trajectories; ///< one for each host
    double position_noise, attitude_noise;             ///< m and rad, of the ways
    double lateness = 0;                               ///< axial strain by which samples come late
};

/// Corrects what the worlds foretold by what the rocks did that carry sensors: optimal
/// interpolation (Gandin 1963). What is left of each world beyond the regression on its beliefs
/// shows how far each rock scatters at each stage, and how alike at which distance; the innovations
/// of the sensors are carried to all others by it. The worlds themselves are not touched, so
/// nothing is put off its equilibrium. No sample is used before its strain, nor before it has come;
/// one far off, and unlike the one before it, is refused. Of a way without rotations gravity's tilt
/// is used. The worlds are packed as the specimen is, or so it is believed: where most sensors, of
/// six or more, are far off the forecast for several samples running, they are of another specimen,
/// and left out from then on (inconsistent_from). Samples are counted and kept (analyses).
ModelRun compute_analysis(const ModelRun& forecast, const RockScatter& scatter,
                          const AssimilatedSensors& sensors);
/// The same for one stage of `run`, which holds the forecast there, whatever specimen the sensors
/// are of.
void compute_analysis_stage(ModelRun& run, const ModelRun& forecast, const RockScatter& scatter,
                            const AssimilatedSensors& sensors, std::size_t stage);

} // namespace bris

#pragma once

#include "systems/procedure/learning.hpp"

namespace bris {

/// How alike rocks at a distance err: near * exp(-distance / length) for two, 1 for one and the same.
struct Likeness {
    double near = 0, length = 0; ///< -, m
    double operator()(double distance) const { return distance > 0 ? near * std::exp(-distance / length) : 1; }
};

/// How the rocks of worlds scatter beyond the regression on their beliefs.
struct RockScatter {
    Likeness displacement, rotation;
    std::vector<double> displacement_variance, rotation_variance; ///< m2 and rad2, of one direction, by stage
};
RockScatter scatter_of(const Worlds& worlds);

/// Corrects what the worlds foretold by what the rocks `hosts` did, which carry sensors: optimal interpolation (Gandin
/// 1963). What is left of each world beyond the regression on its beliefs shows how far rocks scatter at each stage, and
/// how alike at which distance; the innovations of the sensors are carried to all others by it. The worlds themselves are
/// not touched, so nothing is put off its equilibrium. No sample is used before its strain, nor before it has come, `lateness`
/// of strain later; one far off, and unlike the one before it, is refused. Noise: m and rad, of the ways.
ModelRun analyse(ModelRun forecast, const RockScatter& scatter, const std::vector<std::size_t>& hosts, const std::vector<SensorWay>& ways,
                 double position_noise, double attitude_noise, double lateness = 0);

} // namespace bris

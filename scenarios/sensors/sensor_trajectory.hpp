#pragma once

#include "scenarios/sensors/recording.hpp"

#include <string>
#include <vector>

namespace bris {

/// Displacement history of a sensor rock since the start of a test, by axial strain; NaN: not
/// measured.
struct SensorTrajectory {
    std::vector<double> strain;
    std::vector<Vec3> displacement; ///< m, world frame
    std::vector<Vec3> rotation;     ///< rad, rotation vectors, world frame
    /// Upward unit vector at the start minus the current one, in body axes: the part of the
    /// attitude that gravity determines.
    std::vector<Vec3> tilt;
};

/// Extracts the trajectory from the recording of a quasi-static test every `interval` of axial
/// strain: displacement and attitude where recorded, and the tilt from the specific force. Gravity
/// does not determine yaw and displacement, and they are not computed by integration. Throws
/// InputError if the channel `strain` is missing.
SensorTrajectory trajectory_of(const Recording& recording, double interval);

/// Accuracy with which a sensor observes one component of the motion, compared with the drift of a
/// model.
struct Observability {
    std::string direction; ///< x, y, z, tilt, yaw
    std::string source;    ///< channel that observes it
    double deviation; ///< m or rad, standard deviation of the measurement at the end of the test
    double gain;      ///< 1 - P+/P-: share of the variance of the model that it removes
    static constexpr double least_gain = 0.1;
    bool observable() const { return gain > least_gain; }
};

/// Observability in a test of `duration` (s) during which a model drifts by the standard deviations
/// `drift` (m) and `turn` (rad). The displacement from an inertial sensor alone has the error of
/// the second integral of noise and bias. A magnetometer in a steady field observes yaw
/// (heading.hpp) but is not fused: its entry states what could be observed.
std::vector<Observability> observability_of(const Recording& recording, double duration,
                                            double drift, double turn);

} // namespace bris

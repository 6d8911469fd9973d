#pragma once

#include "scenarios/recordings/recording.hpp"

#include <string>
#include <vector>

namespace bris {

/// How a sensor rock has moved since the start of a test, strain by strain; NaN: not measured.
struct SensorTrajectory {
    std::vector<double> strain;
    std::vector<Vec3> displacement; ///< m, world frame
    std::vector<Vec3> rotation;     ///< rad, rotation vectors, world frame
    std::vector<Vec3> tilt; ///< where upwards was, less where it is, in the body's axes: all that
                            ///< gravity tells of attitude
};

/// What a recording tells of a test that passes from one rest to the next: the displacement and
/// attitude that it has, and by the specific force at rest how the rock tilts, every `interval` of
/// axial strain. Of yaw and of displacement gravity says nothing, and they are not made up by
/// integration. Needs the channel `strain`; throws InputError without.
SensorTrajectory trajectory_of(const Recording& recording, double interval);

/// How well a sensor sees one direction, beside what the model may go astray in a test.
struct Observability {
    std::string direction; ///< x, y, z, tilt, yaw
    std::string source;    ///< what it is seen by
    double deviation;      ///< m or rad, of what is measured at the end of the test
    double gain;           ///< 1 - P+/P-: share of the model's variance that it takes away
    bool observable() const { return gain > 0.1; }
};

/// For a test of `duration` (s), in which a model drifts by the deviations `drift` (m) and `turn`
/// (rad). What an inertial sensor alone says of its displacement is the second integral of noise
/// and bias. A magnetometer in a steady field sees yaw (heading.hpp), but is not fused: the verdict
/// says what could be known.
std::vector<Observability> observability_of(const Recording& recording, double duration,
                                            double drift, double turn);
/// Of several, as a table.
std::string observability(const std::vector<Recording>& recordings, double duration, double drift,
                          double turn);

} // namespace bris

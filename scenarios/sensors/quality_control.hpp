#pragma once

#include "scenarios/sensors/recording.hpp"

namespace bris {

/// Limits of the quality control of recordings.
struct QualityControlLimits {
    double rest = 1;       ///< s at the beginning during which the rocks are at rest
    double lost = 0.5;     ///< largest share of missing samples
    double gravity = 0.03; ///< largest deviation of the specific force at rest from g, relative
    /// Largest deviation of the specific force at rest from the vertical, degrees, in addition to
    /// three standard deviations of the initial attitude.
    double frame = 10;
    double saturated = 0.01; ///< largest share of samples at the end of the range
    double noise_ratio = 3;  ///< largest ratio of noise at rest to declared noise, or its inverse
    /// Ratio from which displacement and attitude are refused, because they are weighted by the
    /// declared noise.
    double noise_refused = 10;
    /// Longest time without a change in any digit for a sensor with noise, s; at least three
    /// samples.
    double stuck = 0.5;
    double jump = 0.01; ///< m, largest lasting change of displacement between two samples
    double norm = 1e-3; ///< largest deviation of the norm of a quaternion from 1
    /// Largest change of direction of the specific force, rotated by the attitude, since the rest,
    /// degrees, in addition to three standard deviations of both.
    double tilt = 5;
    /// Largest share of samples beyond the limit of tilt, or of displacement; three samples are
    /// always accepted.
    double outlier_share = 0.1;
    /// Height of the specimen, m; a rock in the upper half of it raises this to twice its own
    /// height.
    double height = 0.3;
    double largest_strain =
        0.5;             ///< axial, that a test can reach; the lowest is a tenth of it below 0
    double turning = 10; ///< rad, largest unsteady rotation of a rock per unit of axial strain
    double clock_drift = 1e-3; ///< largest relative drift of a clock against its sample counter
    double same = 0.999;       ///< correlation from which two recordings count as the same
};

/// One finding. A sensor with a refusal is not used in the fusion.
struct Finding {
    enum class Kind { note, refusal };
    Kind kind;
    unsigned sensor;
    std::string check; ///< one word: gravity, frame, gaps ...
    std::string text;  ///< what was expected and what was found
};

/// Quality control of recordings before any of them is fused: reports faults and repairs nothing.
/// `gravity`: m/s2, world frame. It finds
/// - numbers that are not finite, and samples that the sensor itself flags;
/// - decreasing times, duplicate samples, gaps by time and by count, jitter, drifting clocks;
/// - saturation, stuck values, noise other than declared, two recordings that are the same;
/// - a specific force at rest of another magnitude (units) or direction (signs, frame, exchanged
///   ids);
/// - strains that no test reaches, or of the wrong sign;
/// - displacements that jump, scatter, or are inconsistent with the strain or with other rocks;
/// - attitudes that are not unit quaternions, or are inconsistent with the metadata, gravity or the
///   angular rates;
/// - two rocks of a test at the same place;
/// - angular rates whose sign or axes are inconsistent with the tilt by gravity;
/// - a disturbed magnetic field (and the yaw from a steady one), temperatures, low batteries.
///
/// Limits: the displacement of a rock cannot be distinguished from another one that a rock could
/// make. Wrong signs or axes are therefore detected only where they differ from what all others
/// do: near the top after 0.5 to 1 % of axial strain; at the bottom, where rocks hardly move,
/// never. An error of attitude is detected only as far as the tilt of the rock reveals it; an error
/// in yaw alone is not.
std::vector<Finding> check_recordings(const std::vector<Recording>& recordings, const Vec3& gravity,
                                      const QualityControlLimits& limits = {});

/// A note that these fields of a file are not used; `sensor`: whose file it is.
Finding note_on_unused(unsigned sensor, const std::vector<std::string>& fields);

/// Whether the findings contain no refusal of this sensor.
bool accepted(const std::vector<Finding>& findings, unsigned sensor);

} // namespace bris

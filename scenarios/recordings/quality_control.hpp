#pragma once

#include "scenarios/recordings/recording.hpp"

namespace bris {

/// What the intake of recordings looks for.
struct QualityControlLimits {
    double rest = 1;       ///< s at the beginning, in which the rocks lie still
    double lost = 0.5;     ///< largest share of samples that may be missing
    double gravity = 0.03; ///< by which the specific force at rest may differ from g, of g
    double frame = 10; ///< degrees, by which its direction may differ from upwards, beyond three
                       ///< deviations of the levelling
    double saturated = 0.01;   ///< largest share of samples at the end of the range
    double noise_ratio = 3;    ///< of the noise at rest over that declared, or its inverse
    double noise_refused = 10; ///< that ratio, from which displacement and attitude, weighed by
                               ///< what was declared, are refused
    double stuck = 0.5; ///< s without a change of any digit, of a sensor that has noise; three
                        ///< samples at least
    double jump =
        0.01; ///< m, by which a displacement may change from one sample to the next, and stay so
    double norm = 1e-3; ///< by which a quaternion's may differ from 1
    double tilt = 5;    ///< degrees, by which the force, turned by the attitude, may leave where it
                        ///< pointed at rest, beyond three deviations of both
    double outlier_share = 0.1; ///< largest share of samples that may be farther off than that, or
                                ///< than a rock can go; three may always be
    double height = 0.3; ///< m, of the specimen; where a rock stands above the middle of that,
                         ///< twice as high as the rock
    double turning = 10; ///< rad by which rocks may turn unsteadily in a unit of axial strain
    double clock_drift =
        1e-3;            ///< by which a clock may run fast or slow against its own count of samples
    double same = 0.999; ///< correlation from which two recordings are one and the same
};

/// One finding. A sensor with a refusal takes no part in the fusion.
struct Finding {
    enum class Kind { note, refusal };
    Kind kind;
    unsigned sensor;
    std::string check; ///< one word: gravity, frame, gaps ...
    std::string text;  ///< what was expected and what was found
};

/// Looks at recordings before any of them is fused, and says what is wrong; repairs nothing. Found
/// are: numbers that are not finite, samples that the sensor marks itself, times that go backwards,
/// samples twice, gaps by time and by count, jitter, clocks that drift, saturation, values that
/// stick, displacements that jump, that scatter, or that are longer than the test or others than
/// their neighbours allow, attitudes that are none, not those of the metadata, or against gravity
/// and the rates, a magnetic field that is disturbed (and what a steady one tells of yaw),
/// temperatures, batteries that are low, gravity of another size (units) or direction (signs,
/// frame, ids changed for one another), noise other than declared, recordings that are the same.
/// `gravity`: m/s2, world frame.
///
/// One rock's displacement cannot be told from another that a rock may make: of wrong signs or axes
/// only those are seen that leave what all others do, near the top after 0.5 to 1 % of axial
/// strain, at the bottom, where rocks hardly move, never. An attitude is seen to be wrong by as
/// much as the rock's own tilt shows; one that is wrong in yaw alone is not.
std::vector<Finding> check_recordings(const std::vector<Recording>& recordings, const Vec3& gravity,
                                      const QualityControlLimits& limits = {});

/// Whether there is no refusal of that sensor.
bool accepted(const std::vector<Finding>& findings, unsigned sensor);

/// One line for each finding, and one for each sensor without any.
std::string quality_control_report(const std::vector<Finding>& findings,
                                   const std::vector<Recording>& recordings);

} // namespace bris

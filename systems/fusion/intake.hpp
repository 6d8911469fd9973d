#pragma once

#include "systems/fusion/recording.hpp"

namespace bris {

/// What the intake of recordings looks for.
struct IntakeLimits {
    double rest = 1;                ///< s at the beginning, in which the rocks lie still
    double lost = 0.5;              ///< largest share of samples that may be missing
    double gravity = 0.03;          ///< by which the specific force at rest may differ from g, of g
    double frame = 10;              ///< degrees, by which its direction may differ from upwards, beyond three deviations of the levelling
    double saturated = 0.01;        ///< largest share of samples at the end of the range
    double noise_ratio = 3;         ///< of the noise at rest over that declared, or its inverse
    double stuck = 0.5;             ///< s without a change of any digit, of a sensor that has noise; three samples at least
    double jump = 0.01;             ///< m, by which a displacement may change from one sample to the next, and stay so
    double clock_drift = 1e-3;      ///< by which a clock may run fast or slow against its own count of samples
    double same = 0.999;            ///< correlation from which two recordings are one and the same
};

/// One finding. A sensor with a refusal takes no part in the fusion.
struct Finding {
    enum class Kind { note, refusal };
    Kind kind;
    unsigned sensor;
    std::string check; ///< one word: gravity, frame, gaps ...
    std::string text;  ///< what was expected and what was found
};

/// Looks at recordings before any of them is fused, and says what is wrong; repairs nothing. Found are: numbers that are
/// not finite, times that go backwards, samples twice, gaps, jitter, clocks that drift, saturation, values that stick, displacements that jump,
/// gravity of another size (units) or direction (signs, frame, ids changed for one another), noise other than declared,
/// recordings that are the same. `gravity`: m/s2, world frame.
std::vector<Finding> look_at(const std::vector<Recording>& recordings, const Vec3& gravity, const IntakeLimits& limits = {});

/// Whether there is no refusal of that sensor.
bool accepted(const std::vector<Finding>& findings, unsigned sensor);

/// One line for each finding, and one for each sensor without any.
std::string intake_report(const std::vector<Finding>& findings, const std::vector<Recording>& recordings);

} // namespace bris

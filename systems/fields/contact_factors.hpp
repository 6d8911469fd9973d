#pragma once

#include <algorithm>
#include <limits>

namespace bris {

/// Factors by which fields weaken the contacts of two bodies.
struct ContactFactors {
    double friction = 1; ///< in [0, 1]
    /// Friction does not fall below this, or below that of the materials if that is lower; the
    /// lowest limit of the fields that reduce it.
    double least_friction = std::numeric_limits<double>::infinity();
    double stiffness = 1; ///< of normal and tangential stiffness, in (0, 1]

    void multiply(const ContactFactors& field) {
        friction *= field.friction;
        stiffness *= field.stiffness;
        if (field.friction != 1) least_friction = std::min(least_friction, field.least_friction);
    }
};

} // namespace bris

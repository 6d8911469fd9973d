#pragma once

#include "engine/math.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

/// Set point of a pressure servo. It takes the first target at once and approaches every later one
/// along half a cosine: with a sudden change the oscillation of the wall would overshoot the target
/// by a tenth or more.
struct PressureAim {
    // Fifteen oscillation periods of a wall on the stiffness that sets its mass, each of 2 pi / 0.9
    // steps (ServoMotion). A bed then overshoots by 1 to 2 % at time steps of 0.05 to 0.4
    // sqrt(m / k); with eight periods the overshoot reaches 5 %.
    static constexpr double ramp_steps = 105;

    double from = 0, to = 0; ///< Pa
    double left = -1;        ///< remaining steps of the ramp; below 0 before the first target

    /// Set point (Pa) for the next step.
    double next(double target) {
        if (left < 0) {
            from = to = target;
            left = 0;
        } else if (target != to) {
            from = now();
            to = target;
            left = ramp_steps;
        }
        left = std::max(0.0, left - 1);
        return now();
    }

private:
    double now() const {
        return left > 0 ? to + 0.5 * (from - to) * (1 - std::cos(pi * left / ramp_steps)) : to;
    }
};

} // namespace bris

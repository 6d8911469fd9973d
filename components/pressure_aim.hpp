#pragma once

#include "engine/math.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

/// The pressure that a servo holds now. The first target is taken at once; from then on a new one
/// is reached along half a cosine: told suddenly, the wall's own swing would go past it by a tenth
/// and more.
struct PressureAim {
    // fifteen swings of a wall on the stiffness that sets its mass, 2 pi / 0.9 steps each
    // (ServoMotion): the overshoot of a bed is then 1 to 2 %, at a 20th to two fifths of sqrt(m/k)
    // a step; it reaches 5 % with eight
    static constexpr double ramp_steps = 105;

    double from = 0, to = 0; ///< Pa
    double left = -1; ///< steps of the ramp that are to come; below 0 before the first target

    /// Pa, for the next step.
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

#pragma once

#include "engine/math.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace bris {

/// Axial stress of a cyclic test, which the platen carries beyond the confining pressure: from one
/// turning point to the next along half a cosine, and then constant. In the time of the Clock, so
/// that it does not depend on the time step.
struct LoadRamp {
    double from = 0, to = 0; ///< Pa
    double start = 0;        ///< s
    double duration = 0;     ///< s; 0: there has been no load
    double area = 0; ///< m2, on which the stress is meant; 0: the present one of the specimen
    double mass = 0; ///< kg, of the platen; 0: as light as the time step allows

    /// Stress (Pa) at a time (s).
    double at(double time) const {
        const double done = duration > 0 ? std::clamp((time - start) / duration, 0.0, 1.0) : 1;
        return to + 0.5 * (from - to) * (1 + std::cos(pi * done));
    }
    /// Force (N) at a time (s) on a specimen of this present area (m2).
    double force(double time, double present) const {
        return at(time) * (area > 0 ? area : present);
    }

    static auto fields(auto& self) {
        return std::tie(self.from, self.to, self.start, self.duration, self.area, self.mass);
    }
};

} // namespace bris
